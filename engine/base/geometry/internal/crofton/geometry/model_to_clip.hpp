// SPDX-License-Identifier: MIT
// The float matrix that takes a placed mesh to clip space.
#pragma once
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace crofton::detail {

// Returns the matrix for the placement x ↦ linear · x + translation; `to_clip` takes world positions relative to
// `origin`. It is composed in double and rounded once, so precision does not suffer at large offsets.
[[nodiscard]] inline glm::mat4 model_to_clip(const glm::dmat4& to_clip, const glm::dvec3& origin,
                                             const glm::dmat3& linear, const glm::dvec3& translation) {
    glm::dmat4 placement(linear);
    placement[3] = glm::dvec4(translation - origin, 1.0);
    return glm::mat4(to_clip * placement);
}

}  // namespace crofton::detail
