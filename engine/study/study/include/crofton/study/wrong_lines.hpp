// SPDX-License-Identifier: MIT
// Line densities that look uniform and are not, for teaching, and for tests, which must reject them. Never sample with
// these.
#pragma once
#include <array>
#include <crofton/sampling/sampling.hpp>
#include <glm/vec2.hpp>

namespace crofton::study::wrong {

// Returns the line through two uniform points of a box's surface: too many lines near the faces.
[[nodiscard]] Line line_through_two_box_points(const Aabb& box, const std::array<double, 6>& u);

// Returns a line from a sphere point in a uniform instead of a cosine-weighted inward direction: too many grazing
// lines.
[[nodiscard]] Line line_from_sphere_uniform_direction(const Sphere& sphere, const std::array<double, 4>& u);

// Returns the line through two uniform points of a circle: right on the sphere, wrong in the plane (Bertrand's
// paradox).
struct PlaneLine {
    glm::dvec2 point{0.0};
    glm::dvec2 direction{1.0, 0.0};
};
[[nodiscard]] PlaneLine line_through_two_circle_points(double radius, const std::array<double, 2>& u);

}  // namespace crofton::study::wrong
