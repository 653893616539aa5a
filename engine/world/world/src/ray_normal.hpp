// SPDX-License-Identifier: MIT
// Normals of ray hits: unit length, towards the ray's origin; 0 if the ray began inside.
#pragma once
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/shapes.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace crofton::world {

// Turned against the ray.
[[nodiscard]] inline glm::dvec3 facing(const Ray& ray, const glm::dvec3& normal) {
    const double length = glm::length(normal);
    if (!(length > 0.0)) return -glm::normalize(ray.direction);
    return (glm::dot(normal, ray.direction) > 0.0 ? -1.0 : 1.0) / length * normal;
}

// Returns the normal of a sphere where the ray meets it, at t.
[[nodiscard]] inline glm::dvec3 normal_of(const Ray& ray, const Sphere& sphere, double t) {
    const glm::dvec3 to = ray.origin - sphere.center;
    if (glm::dot(to, to) <= sphere.radius * sphere.radius) return glm::dvec3(0.0);
    return facing(ray, to + t * ray.direction);
}

// Returns the normal of a box that the ray meets at t: that of the face whose plane the ray enters last.
[[nodiscard]] inline glm::dvec3 normal_of(const Ray& ray, const Obb& box, double t) {
    const glm::dvec3 offset = ray.origin - box.center;
    double last = -std::numeric_limits<double>::infinity();
    glm::dvec3 normal(0.0);
    bool inside = t == 0.0;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 n = glm::cross(glm::dvec3(box.axes[(k + 1) % 3]), glm::dvec3(box.axes[(k + 2) % 3]));
        const double half = static_cast<double>(box.half_extents[k]) * std::abs(glm::dot(n, glm::dvec3(box.axes[k])));
        const double at = glm::dot(n, offset), speed = glm::dot(n, ray.direction);
        inside = inside && std::abs(at) <= half;
        if (speed == 0.0) continue;
        const double enter = ((speed > 0.0 ? -half : half) - at) / speed;
        if (enter > last) {
            last = enter;
            normal = n;
        }
    }
    return inside ? glm::dvec3(0.0) : facing(ray, normal);
}

// Returns the normal of a triangle under a linear map.
[[nodiscard]] inline glm::dvec3 normal_of(const Ray& ray, const Triangle& triangle, const glm::dmat3& linear) {
    return facing(ray, glm::cross(linear * (triangle[1] - triangle[0]), linear * (triangle[2] - triangle[0])));
}

}  // namespace crofton::world
