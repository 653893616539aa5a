// The best circle, box or rectangle around an object of the plane, given the bounds of its ancestors: the one that the
// fewest lines hit together with all of them (theory.md section 4; two-level is one ancestor, n-level is n − 1).
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/study/planar_support.hpp>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>

namespace crofton::study {

// `measure`: of the lines that hit the bound and all ancestors. No bound of its kind has one below `lower_bound`, which
// is within the tolerance of `measure` unless noted. `bound` contains every point.
template <class Bound>
struct OptimalBound {
    Bound bound;
    double measure = 0.0;
    double lower_bound = 0.0;
    std::uint64_t evaluations = 0;  // how many bounds were measured
};

struct BoundOptions {
    double tolerance = 1e-9;  // relative to the measure of the ancestors alone; at least 1e-12
};

// `ancestors` is the lower envelope of the ancestors' support functions (lower_envelope; a single figure as it is).
// Errors of all three: no points, a point NaN or infinite (by index), an object that its ancestors' bounds do not
// contain.
//
// Why a search along the farthest-point Voronoi diagram finds the best circle: the measure is ∫ min(h_ancestors, h_K),
// as all contain the object; it grows with K, so a circle that touches the object in one point only can shrink towards
// it. The rest pass through two corners: one family of circles for each of the diagram's O(n) edges. Along an edge,
// with t the centre's place and r(t) convex, the measure is at least the smaller value at the ends of an interval less
// 2π·max r″·Δt²/8 (it is concave and increasing in centre and radius): so intervals are dropped by proof, and halved
// where they are not. O(n log n) for the diagram, then one walk over the ancestors' pieces for each measured circle.
[[nodiscard]] Result<OptimalBound<Disc>> optimal_disc(std::span<const glm::dvec2> object,
                                                      const PlanarSupport& ancestors, const BoundOptions& options = {});

// Sides parallel to the axes: the tight one, whatever the ancestors.
[[nodiscard]] Result<OptimalBound<Rectangle>> optimal_box(std::span<const glm::dvec2> object,
                                                          const PlanarSupport& ancestors);

// Any orientation. Given ancestors the best rectangle need not have a flush side (without, it has: rotating calipers).
// Between changes of support corner the measure at an angle is at least the smaller value at the ends of an interval
// less 8·diameter·Δθ²: the corners move on circles (Thales), which bends each sinusoid by at most 2·diameter·Δθ²/8, and
// the kinks of h_K at the four sides' normals lie within four windows of width Δθ and take at most √2·diameter·Δθ each.
[[nodiscard]] Result<OptimalBound<Rectangle>> optimal_rectangle(std::span<const glm::dvec2> object,
                                                                const PlanarSupport& ancestors,
                                                                const BoundOptions& options = {});

}  // namespace crofton::study
