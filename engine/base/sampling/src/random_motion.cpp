// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/geometry/orthonormal_frame.hpp>
#include <crofton/geometry/trigonometry.hpp>
#include <crofton/sampling/sampling.hpp>
#include <numbers>

namespace crofton::sampling {

glm::dvec2 circle_point(double u) {
    // The rest beyond the nearest quarter turn is exact.
    const double quarter = std::floor(4.0 * u + 0.5);
    return detail::cosine_sine_beyond(static_cast<std::int64_t>(quarter),
                                      2.0 * std::numbers::pi * (u - 0.25 * quarter));
}

glm::dvec3 direction(const std::array<double, 2>& u) {
    const double z = 1.0 - 2.0 * u[0];
    const glm::dvec2 xy = std::sqrt(std::max(0.0, 1.0 - z * z)) * circle_point(u[1]);
    return {xy.x, xy.y, z};
}

glm::dvec2 disc_point(const std::array<double, 2>& u) {
    return std::sqrt(u[0]) * circle_point(u[1]);
}

glm::dvec3 ball_point(const std::array<double, 3>& u) {
    // The radius has density 3r² : the largest of three uniform numbers has it, but one number is to do.
    return cube_root(u[2]) * direction({u[0], u[1]});
}

std::array<glm::dvec3, 2> orthonormal_frame(const glm::dvec3& axis) {
    return crofton::orthonormal_frame(axis);
}

glm::dvec3 cosine_direction(const glm::dvec3& normal, const std::array<double, 2>& u) {
    const glm::dvec2 disc = disc_point(u);  // Malley: lift a uniform disc point to the hemisphere
    const auto [x, y] = orthonormal_frame(normal);
    return disc.x * x + disc.y * y + std::sqrt(std::max(0.0, 1.0 - u[0])) * normal;
}

glm::dmat3 rotation(const std::array<double, 3>& u) {
    const glm::dvec2 xy = std::sqrt(1.0 - u[0]) * circle_point(u[1]);
    const glm::dvec2 zw = std::sqrt(u[0]) * circle_point(u[2]);
    const double x = xy.x, y = xy.y, z = zw.x, w = zw.y;
    return {glm::dvec3(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)),
            glm::dvec3(2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)),
            glm::dvec3(2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y))};
}

glm::dmat2 planar_rotation(double u) {
    const glm::dvec2 c = circle_point(u);
    return {c, glm::dvec2(-c.y, c.x)};
}

glm::dvec3 box_point(const Aabb& box, const std::array<double, 3>& u) {
    return box.min + glm::dvec3(u[0], u[1], u[2]) * (box.max - box.min);
}

RigidTransform motion(const Aabb& translations, const std::array<double, 6>& u) {
    return {rotation({u[0], u[1], u[2]}), box_point(translations, {u[3], u[4], u[5]})};
}

PlanarMotion planar_motion(const glm::dvec2& low, const glm::dvec2& high, const std::array<double, 3>& u) {
    return {planar_rotation(u[0]), low + glm::dvec2(u[1], u[2]) * (high - low)};
}

Camera random_camera(const Camera& prototype, const Aabb& positions, const std::array<double, 6>& u) {
    const RigidTransform move = motion(positions, u);
    Camera camera = prototype;
    camera.position = move.translation;
    camera.forward = move.rotation[0];
    camera.up = move.rotation[1];
    return camera;
}

}  // namespace crofton::sampling
