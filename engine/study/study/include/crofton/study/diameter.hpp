// SPDX-License-Identifier: MIT
// The diameter of a set of points: the largest distance of two of them, which is the largest breadth of their hull.
#pragma once
#include <crofton/core/error.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::study {

// `from` and `to` are points of the set; the breadth across to − from is their distance.
template <class Point>
struct Diameter {
    double length = 0.0;
    Point from{0.0}, to{0.0};
};

// Returns the diameter, up to rounding (about 1e-15 of the length); 0 for one point.
//
// In the plane it uses rotating calipers around the hull: O(n log n). In space it tests pairs of the hull's corners,
// those far from the middle first, until two such distances cannot add up to more than the best so far: O(h²) at worst,
// for h corners on a sphere. Errors: no points; a coordinate that is NaN, infinite or beyond kMaxCoordinate, by index.
[[nodiscard]] Result<Diameter<glm::dvec2>> diameter(std::span<const glm::dvec2> points);
[[nodiscard]] Result<Diameter<glm::dvec3>> diameter(std::span<const glm::dvec3> points);

}  // namespace crofton::study
