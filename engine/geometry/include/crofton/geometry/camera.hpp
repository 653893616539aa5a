// SPDX-License-Identifier: MIT
// What an engine knows of its view, and the matrices that follow.
#pragma once
#include <crofton/core/error.hpp>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <limits>

namespace crofton {

enum class Projection : std::uint8_t { perspective, orthographic };

// How depth comes out of the projection. Ours is reversed-Z: near → 1, far → 0 (docs/conventions.md).
enum class DepthRange : std::uint8_t {
    reversed_zero_to_one,  // Vulkan/Direct3D clip volume 0 ≤ z ≤ w, near at w: the default
    zero_to_one,           // Vulkan/Direct3D clip volume 0 ≤ z ≤ w, near at 0
    minus_one_to_one,      // OpenGL clip volume −w ≤ z ≤ w, near at −w
};

// Right-handed: looks along `forward`, `up` need not be perpendicular to it. Angles in radians, lengths in metres.
struct Camera {
    glm::dvec3 position{0.0};
    glm::dvec3 forward{0.0, 0.0, -1.0};
    glm::dvec3 up{0.0, 1.0, 0.0};
    Projection projection = Projection::perspective;
    double fov_y = 1.0471975511965976;  // full vertical angle in (0, π); perspective only
    double height = 10.0;               // full height of the view volume; orthographic only
    double aspect = 16.0 / 9.0;         // width / height
    double near_distance = 0.1;         // to the near plane, along `forward`
    double far_distance = 1000.0;       // to the far plane; infinity allowed (perspective only)
};

// Errors: non-finite values, forward parallel to up, fov, aspect, height, near or far distance out of range.
[[nodiscard]] Result<void> validate(const Camera& camera);

// Rotation only: world directions to view directions (x right, y up, −z forward).
[[nodiscard]] glm::dmat3 world_to_view_rotation(const Camera& camera);

// View space to clip space; y up (a Vulkan viewport of negative height flips the picture, not the matrix).
[[nodiscard]] glm::dmat4 view_to_clip(const Camera& camera, DepthRange depth = DepthRange::reversed_zero_to_one);

// view_to_clip · world_to_view, the translation included: rounds at large coordinates, see frustum_of(Camera) instead.
[[nodiscard]] glm::dmat4 world_to_clip(const Camera& camera, DepthRange depth = DepthRange::reversed_zero_to_one);

}  // namespace crofton
