// SPDX-License-Identifier: MIT
// The triangle of least perimeter around points that nearly lie on a line.
#pragma once
#include <array>
#include <glm/vec2.hpp>
#include <optional>
#include <span>

namespace crofton::fit {

using Triangle2 = std::array<glm::dvec2, 3>;

[[nodiscard]] bool holds(const Triangle2& triangle, std::span<const glm::dvec2> points);
[[nodiscard]] double perimeter_of(const Triangle2& triangle);

// Around a hull, counter-clockwise and of three corners or more, of thickness t and length L ≫ t: the least of the
// triangles with one sharp corner, at or beyond an end of the hull, and the side across from it upright at the other
// end, within t of 2 L and more. Those with two sharp corners on one side are best_triangle()'s. Contains the hull,
// decided exactly. None where no rounding of the corners does.
[[nodiscard]] std::optional<Triangle2> least_sliver(std::span<const glm::dvec2> hull);

}  // namespace crofton::fit
