// SPDX-License-Identifier: MIT
// Preferred directions: M and F for queries that do not come from all directions alike (section 3.4 of the paper).
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/study/convex_body.hpp>
#include <cstdint>
#include <span>

namespace crofton::study {

// A density over directions, in which n and −n count alike. The positions of queries stay uniform.
class QueryDistribution {
  public:
    QueryDistribution() = default;  // uniform: measures are M, and π·F/2
    // Returns uniform directions within `half_width` radians of the plane perpendicular to `up`: a horizon. Errors:
    // `up` zero or not finite; half_width outside (0, π/2].
    [[nodiscard]] static Result<QueryDistribution> band(const glm::dvec3& up, double half_width);
    // Returns your own directions; without weights they weigh the same. Errors: no directions; one that is zero or not
    // finite (by index); sizes that do not match; a weight that is negative or not finite (by index); all weights 0.
    [[nodiscard]] static Result<QueryDistribution> samples(std::span<const glm::dvec3> directions,
                                                           std::span<const double> weights = {});
    // Returns the normals of the faces of a path's view volumes, weighted by their areas. For views that are large
    // compared with the objects, false positives are those of the planes through these faces. Errors: no cameras; as
    // intrinsic_volumes_of_frustum, with the camera's index.
    [[nodiscard]] static Result<QueryDistribution> of_views(std::span<const Camera> cameras);

    // Returns the mean of |dot(n, u)| for a unit vector u: 1/2 for uniform directions.
    [[nodiscard]] double mean_cosine(const glm::dvec3& u) const;

    // Returns the measure of the planes with such normals that hit the body, 2π × the mean width. For a box it is 2π Σ
    // edge_k · mean_cosine(axis_k), for others a sum over the directions. For uniform directions it is M. NaN if a
    // point is not finite, or there is none.
    [[nodiscard]] double measure_of_planes(const Obb& box) const;
    [[nodiscard]] double measure_of_planes(const ConvexBody& body) const;
    // Returns the measure of the lines with such directions, 2π × the mean shadow: for a box 2π Σ face_k ·
    // mean_cosine(axis_k), each pair of faces once.
    [[nodiscard]] double measure_of_lines(const Obb& box) const;

  private:
    Vector<glm::dvec3> directions_;  // unit vectors; empty: uniform
    Vector<double> weights_;         // sum 1
};

enum class QueryKind : std::uint8_t { planes, lines };

struct DirectedFit {
    Obb box;
    Obb plain;                 // the best box for uniform directions
    double value = 0.0;        // of `box`: its measure under the distribution
    double plain_value = 0.0;  // of `plain`
    double lower_bound = 0.0;  // for planes: the measure of the points' hull, which every box contains; for lines 0
};

// Finds the box of least measure under the distribution, by a downhill search from the plain box, the world's axes and
// eight rotations. It is never worse than the plain box, and contains every point. Errors: as fit_obb.
[[nodiscard]] Result<DirectedFit> fit_box_for(std::span<const glm::dvec3> points, const QueryDistribution& distribution,
                                              QueryKind kind);

}  // namespace crofton::study
