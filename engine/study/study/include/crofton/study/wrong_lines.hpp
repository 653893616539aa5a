// SPDX-License-Identifier: MIT
// Line densities that look uniform and are not: for tests, which must reject them, and for teaching. Never sample with
// these.
#pragma once
#include <array>
#include <crofton/sampling/sampling.hpp>
#include <glm/vec2.hpp>

namespace crofton::study::wrong {

// Two uniform points of a box's surface: crowds the lines along the faces.
[[nodiscard]] Line line_through_two_box_points(const Aabb& box, const std::array<double, 6>& u);

// From a sphere point in a uniform instead of a cosine-weighted inward direction: too many grazing lines.
[[nodiscard]] Line line_from_sphere_uniform_direction(const Sphere& sphere, const std::array<double, 4>& u);

// Two uniform points of a circle: right on the sphere, wrong in the plane (Bertrand's paradox).
struct PlaneLine {
    glm::dvec2 point{0.0};
    glm::dvec2 direction{1.0, 0.0};
};
[[nodiscard]] PlaneLine line_through_two_circle_points(double radius, const std::array<double, 2>& u);

}  // namespace crofton::study::wrong
