// SPDX-License-Identifier: MIT
// Directions perpendicular to a direction.
#pragma once
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
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

// Returns a unit vector perpendicular to u. Requires that products of u's components neither vanish nor overflow.
[[nodiscard]] inline glm::dvec3 unit_across(const glm::dvec3& u) {
    const glm::dvec3 size = glm::abs(u);
    const int least = size.x <= size.y && size.x <= size.z ? 0 : (size.y <= size.z ? 1 : 2);
    glm::dvec3 axis(0.0);
    axis[least] = 1.0;
    return glm::normalize(glm::cross(u, axis));
}

}  // namespace crofton
