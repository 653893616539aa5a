// SPDX-License-Identifier: MIT
// Cells of rotations, for branch and bound: cubes of Rodrigues vectors (tan(angle / 2) · axis).
#pragma once
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace crofton::study {

// Half the side of a cube that holds, up to the 24 rotations of a cube, every rotation: tan(π/8), rounded up.
inline constexpr double kHalfOfAllRotations = 0.41421356237309515;

// The rotation of Rodrigues vector g.
[[nodiscard]] inline glm::dmat3 rotation_of(const glm::dvec3& g) {
    glm::dmat3 result;
    const double scale = 2.0 / (1.0 + glm::dot(g, g));
    for (int k = 0; k < 3; ++k) {
        glm::dvec3 e(0.0);
        e[k] = 1.0;
        const glm::dvec3 once = glm::cross(g, e);
        result[k] = e + scale * (once + glm::cross(g, once));
    }
    return result;
}

// The Rodrigues vector of rotation_of(g) · rotation_of(from)⁻¹. A projective map of g: cubes become polytopes whose
// corners are the images of theirs, as long as 1 + dot(g, from) > 0.
[[nodiscard]] inline glm::dvec3 turn_between(const glm::dvec3& from, const glm::dvec3& g) {
    return (g - from - glm::cross(g, from)) / (1.0 + glm::dot(g, from));
}

[[nodiscard]] inline glm::dvec3 corner_of(const glm::dvec3& center, double half, unsigned corner) {
    return center + half * glm::dvec3(corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0);
}

}  // namespace crofton::study
