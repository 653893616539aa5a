// SPDX-License-Identifier: MIT
// Rectangle: the oriented box of the plane.
#pragma once
#include <crofton/core/requirements.hpp>
#include <glm/vec2.hpp>

namespace crofton {

// The points p with |dot(axis, p − center)| ≤ half_extents.x and |dot(perp(axis), p − center)| ≤ half_extents.y, where
// perp(x, y) = (−y, x). `axis` has unit length up to rounding.
struct Rectangle {
    glm::dvec2 center{0.0};
    glm::dvec2 axis{1.0, 0.0};
    glm::dvec2 half_extents{0.0};
};

[[nodiscard]] inline double area(const Rectangle& rectangle) {
    return 4.0 * rectangle.half_extents.x * rectangle.half_extents.y;
}
[[nodiscard]] inline double perimeter(const Rectangle& rectangle) {
    return 4.0 * (rectangle.half_extents.x + rectangle.half_extents.y);
}

}  // namespace crofton
