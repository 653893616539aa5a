// SPDX-License-Identifier: MIT
// Directions across a direction.
#pragma once
#include <array>
#include <cmath>
#include <glm/vec3.hpp>

namespace crofton {

// Two unit vectors that complete the unit vector `axis` to a right-handed frame (first, second, axis). Duff et al.,
// "Building an orthonormal basis, revisited", 2017.
[[nodiscard]] inline std::array<glm::dvec3, 2> orthonormal_frame(const glm::dvec3& axis) {
    const double sign = std::copysign(1.0, axis.z);
    const double a = -1.0 / (sign + axis.z);
    const double b = axis.x * axis.y * a;
    return {glm::dvec3(1.0 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x),
            glm::dvec3(b, sign + axis.y * axis.y * a, -axis.y)};
}

}  // namespace crofton
