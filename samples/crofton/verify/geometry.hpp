// SPDX-License-Identifier: MIT
// Measures for `crofton verify`: volumes, shadows and widths from corners alone, averaged over rotations or directions,
// without intrinsic volumes or kinematic formulas.
#pragma once
#include <cstdint>
#include <functional>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "bodies.hpp"
#include "rows.hpp"

namespace crofton::cli {

using Corners3 = std::vector<glm::dvec3>;

[[nodiscard]] double hull_volume(const Corners3& corners);  // by tetrahedra
[[nodiscard]] double hull_area(const Figure& points);       // by the shoelace formula; of the plane
[[nodiscard]] double shadow_area(const Corners3& corners, const glm::dvec3& direction);
[[nodiscard]] double breadth(const Corners3& corners, const glm::dvec3& direction);
// A convex polytope by its faces: triangles of its hull; flat ones have two faces, segments and points none.
struct Faceted {
    struct Face {
        glm::dvec3 normal;  // outward unit vector
        double area;
    };
    Corners3 corners;
    std::vector<Face> faces;
    double volume = 0.0;
};
[[nodiscard]] Faceted faceted(const Corners3& points);
// The volume of the places at which B, turned by `rotation`, meets K: that of K ⊕ −B (Minkowski) = V(K) + V(B) + Σ over
// K's faces of area · support of −B + Σ over B's faces of area · support of K.
[[nodiscard]] double meeting_volume(const Faceted& b, const Faceted& k, const glm::dmat3& rotation);
// The same by the sums of corners and their hull: slow, and nothing else.
[[nodiscard]] double meeting_volume_by_hull(const Corners3& b, const Corners3& k, const glm::dmat3& rotation);
// The volume of the places at which B, a body with outward faces turned by `rotation`, contains K, as long as B keeps
// all its corners when its faces move inward.
[[nodiscard]] double containing_volume(const Body& b, const Corners3& k, const glm::dmat3& rotation);

// Means over 128 batches of quasi-random points, each batch shifted by itself: evenly spread, with an honest error.
// `points` a batch: a power of two.
// With fewer trials than the default, a sixteenth of the points.
[[nodiscard]] std::uint64_t effort(const VerifyOptions& options, std::uint64_t points);
[[nodiscard]] Mean mean_over_rotations(std::uint64_t seed, std::uint64_t points,
                                       const std::function<double(const glm::dmat3&)>& value);
[[nodiscard]] Mean mean_over_directions(std::uint64_t seed, std::uint64_t points,
                                        const std::function<double(const glm::dvec3&)>& value);
// The mean over all angles of a piecewise smooth function, by 2^14 midpoints: off by less than 1e-6 of its size.
[[nodiscard]] double mean_over_angles(const std::function<double(double)>& value);

// The common part of two convex figures, counter-clockwise.
[[nodiscard]] Figure clipped(const Figure& figure, const Figure& by);

}  // namespace crofton::cli
