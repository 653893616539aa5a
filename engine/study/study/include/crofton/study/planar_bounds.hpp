// SPDX-License-Identifier: MIT
// The best disc, box or rectangle around a plane object whose ancestors' bounds are given: the one that the fewest
// lines hit together with all of them (docs/theory.md, section 4). The paper's n-level case has n − 1 ancestors.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/study/planar_support.hpp>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>

namespace crofton::study {

// A best bound with a proof. `measure` is that of the lines that hit the bound and all ancestors. No bound of its kind
// has a measure below `lower_bound`, which is within the tolerance of `measure`. `bound` contains every point. Both
// numbers have the integrals' rounding: at most 4e-15 of the largest |coordinate| for each piece of the two support
// functions.
template <class Bound>
struct OptimalBound {
    Bound bound;
    double measure = 0.0;
    double lower_bound = 0.0;
    std::uint64_t evaluations = 0;  // the number of bounds measured
};

struct BoundOptions {
    double tolerance = 1e-9;  // relative to the measure of the ancestors alone; at least 1e-12, and the rounding
};

// These three functions find the best bound. `ancestors` is the lower envelope of the ancestors' support functions
// (lower_envelope; for a single figure its own).
//
// Errors: no points; a point NaN or infinite (by index); an object that its ancestors' bounds do not contain. The
// largest |coordinate| or radius of the ancestors must lie in [1e-80, 1e100]; around a point it may be less.
//
// optimal_disc searches along the farthest-point Voronoi diagram. The measure is ∫ min(h_ancestors, h_K), because all
// contain the object, and grows with K. A disc that touches the object in only one point can shrink towards it, so the
// best disc passes through two corners. There is one family of discs for each of the diagram's O(n) edges. Along an
// edge, with t the centre's place and r(t) convex, the measure is concave and increasing in centre and radius. So on an
// interval it is at least the smaller value at its ends less 2π·max r″·Δt²/8; intervals are dropped by this bound or
// halved. O(n log n) for the diagram, then one pass over the ancestors' pieces for each disc measured.
[[nodiscard]] Result<OptimalBound<Disc>> optimal_disc(std::span<const glm::dvec2> object,
                                                      const PlanarSupport& ancestors, const BoundOptions& options = {});

// Returns the best box with sides parallel to the axes: the tight one, for all ancestors.
[[nodiscard]] Result<OptimalBound<Rectangle>> optimal_box(std::span<const glm::dvec2> object,
                                                          const PlanarSupport& ancestors);

// Returns the best rectangle of any orientation.
//
// With ancestors it need not have a flush side; without them it has one (rotating calipers). Between changes of support
// corner, the measure at an angle is at least the smaller value at the ends of an interval less 8·diameter·Δθ². The
// corners move on circles (Thales), which bends each sinusoid by at most 2·diameter·Δθ²/8. The kinks of h_K at the four
// sides' normals lie within four windows of width Δθ and take at most √2·diameter·Δθ each.
[[nodiscard]] Result<OptimalBound<Rectangle>> optimal_rectangle(std::span<const glm::dvec2> object,
                                                                const PlanarSupport& ancestors,
                                                                const BoundOptions& options = {});

}  // namespace crofton::study
