// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace crofton::world {

// Quick; false where the map is no rotation, or is one within the tolerance of poses but not clearly.
[[nodiscard]] inline bool is_clearly_rotation(const glm::dmat3& linear) {
    constexpr double kClearly = 2e-7;
    const glm::dvec3 &x = linear[0], &y = linear[1], &z = linear[2];
    const double most =
        std::max({std::abs(glm::dot(x, x) - 1.0), std::abs(glm::dot(y, y) - 1.0), std::abs(glm::dot(z, z) - 1.0),
                  std::abs(glm::dot(x, y)), std::abs(glm::dot(y, z)), std::abs(glm::dot(z, x))});
    return most <= kClearly && glm::dot(glm::cross(x, y), z) > 0.0;
}

// Whether a matrix can be inverted. A product of rotations and a flat scale may keep a determinant of rounding: 2^-52
// of the product of its columns' lengths. The inverse of one that passes is off by a thousandth of the mesh's size at
// most, and by rounding where nothing is nearly flat.
[[nodiscard]] inline bool is_invertible(const glm::dmat3& m) {
    double sizes = 1.0;
    for (int k = 0; k < 3; ++k) sizes *= std::abs(m[k].x) + std::abs(m[k].y) + std::abs(m[k].z);
    return std::abs(glm::determinant(m)) > 1e-12 * sizes;
}

}  // namespace crofton::world
