// SPDX-License-Identifier: MIT
// Points and directions on patches, and colours there.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/lines/lines.hpp>
#include <crofton/radiosity/patches.hpp>
#include <crofton/sampling/sampling.hpp>
#include <glm/geometric.hpp>

namespace crofton::radiosity {

// Returns the sum of red, green and blue.
[[nodiscard]] inline double total(const glm::dvec3& color) {
    return color.r + color.g + color.b;
}

struct Corners {
    glm::dvec3 a, b, c;
};
inline Corners corners_of(const Patches& patches, std::uint32_t triangle) {
    const auto at = [&](std::uint32_t k) {
        return glm::dvec3(patches.mesh.positions[patches.mesh.indices[3 * triangle + k]]);
    };
    return {at(0), at(1), at(2)};
}

// A uniform point of a triangle, and a direction over its front whose cosine against the normal is `cosine`.
inline lines::FirstHitQuery local_ray(const Patches& patches, std::uint32_t triangle, double u, double v, double cosine,
                                      double turn) {
    const Corners t = corners_of(patches, triangle);
    const double root = std::sqrt(u);
    const glm::dvec3 point = t.a + root * (1.0 - v) * (t.b - t.a) + root * v * (t.c - t.a);
    const glm::dvec3 normal = glm::normalize(glm::cross(t.b - t.a, t.c - t.a)), side = glm::normalize(t.b - t.a);
    const glm::dvec2 around = std::sqrt(std::max(0.0, 1.0 - cosine * cosine)) * sampling::circle_point(turn);
    lines::FirstHitQuery ray;
    ray.line.point = point;
    ray.line.direction = cosine * normal + around.x * side + around.y * glm::cross(normal, side);
    ray.skip = triangle;
    return ray;
}

}  // namespace crofton::radiosity
