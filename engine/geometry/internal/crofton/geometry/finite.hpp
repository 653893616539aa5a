// SPDX-License-Identifier: MIT
// Infinity, and whether numbers are finite.
#pragma once
#include <cmath>
#include <glm/vec3.hpp>
#include <limits>

namespace crofton {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

[[nodiscard]] inline bool is_finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace crofton
