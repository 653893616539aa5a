// SPDX-License-Identifier: MIT
// Infinity, and whether numbers are finite and in range.
#pragma once
#include <cmath>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/shapes.hpp>
#include <glm/vec3.hpp>
#include <limits>

namespace crofton {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

[[nodiscard]] inline bool is_finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Whether the coordinates are in range for a body. False for NaN.
[[nodiscard]] inline bool is_in_range(const glm::dvec3& v) {
    return std::abs(v.x) <= kMaxCoordinate && std::abs(v.y) <= kMaxCoordinate && std::abs(v.z) <= kMaxCoordinate;
}
[[nodiscard]] inline bool is_in_range(const Aabb& box) {
    return is_in_range(box.min) && is_in_range(box.max);
}
// Whether queries accept the sphere.
[[nodiscard]] inline bool is_in_range(const Sphere& sphere) {
    return is_in_range(sphere.center) && sphere.radius >= 0.0 && sphere.radius <= kMaxCoordinate;
}

}  // namespace crofton
