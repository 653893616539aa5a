// SPDX-License-Identifier: MIT
// Intersects a ray with a sphere.
#pragma once
#include <cmath>
#include <crofton/geometry/shapes.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <glm/geometric.hpp>
#include <optional>

namespace crofton::world {

// 0 where the ray starts inside. Rounded. The discriminant is that of the distance from the centre to the line, which
// keeps its digits for small spheres far away (Haines, Günther, Akenine-Möller 2019).
[[nodiscard]] inline std::optional<double> raycast(const Ray& ray, const Sphere& sphere) {
    const glm::dvec3 to_center = sphere.center - ray.origin;
    const double outside = glm::dot(to_center, to_center) - sphere.radius * sphere.radius;
    if (outside <= 0.0) return 0.0;
    const double squared = glm::dot(ray.direction, ray.direction), along = glm::dot(to_center, ray.direction);
    if (!(along > 0.0)) return std::nullopt;
    const glm::dvec3 off = to_center - (along / squared) * ray.direction;
    const double half_chord = sphere.radius * sphere.radius - glm::dot(off, off);
    if (!(half_chord >= 0.0)) return std::nullopt;
    const double t = outside / (along + std::sqrt(squared * half_chord));
    return t <= ray.max_t ? std::optional(t) : std::nullopt;
}

}  // namespace crofton::world
