// SPDX-License-Identifier: MIT
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/wrong_lines.hpp>
#include <glm/geometric.hpp>

namespace crofton::study::wrong {

Line line_through_two_box_points(const Aabb& box, const std::array<double, 6>& u) {
    // A line from a box begins at a uniform point of its surface.
    const glm::dvec3 a = sampling::line_from_box(box, {u[0], u[1], u[2], 0.0, 0.0}).point;
    const glm::dvec3 b = sampling::line_from_box(box, {u[3], u[4], u[5], 0.0, 0.0}).point;
    const double length = glm::length(b - a);
    return {a, length > 0.0 ? (b - a) / length : glm::dvec3(0.0, 0.0, 1.0)};
}

Line line_from_sphere_uniform_direction(const Sphere& sphere, const std::array<double, 4>& u) {
    const glm::dvec3 normal = sampling::direction({u[0], u[1]});
    glm::dvec3 d = sampling::direction({u[2], u[3]});
    if (glm::dot(d, normal) > 0.0) d = -d;
    return {sphere.center + sphere.radius * normal, d};
}

PlaneLine line_through_two_circle_points(double radius, const std::array<double, 2>& u) {
    const glm::dvec2 a = radius * sampling::circle_point(u[0]), b = radius * sampling::circle_point(u[1]);
    const double length = glm::length(b - a);
    return {a, length > 0.0 ? (b - a) / length : glm::dvec2(1.0, 0.0)};
}

}  // namespace crofton::study::wrong
