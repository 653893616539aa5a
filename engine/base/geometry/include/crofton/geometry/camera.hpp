// SPDX-License-Identifier: MIT
// Cameras, and the view volumes that culling tests against.
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/geometry/shapes.hpp>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

namespace crofton {

// Cameras and their matrices.

enum class Projection : std::uint8_t { perspective, orthographic };

// The depth range of a projection. Crofton's own projections are reversed-Z: near → 1, far → 0 (docs/conventions.md).
enum class DepthRange : std::uint8_t {
    reversed_zero_to_one,  // Vulkan/Direct3D clip volume 0 ≤ z ≤ w, near at w: the default
    zero_to_one,           // Vulkan/Direct3D clip volume 0 ≤ z ≤ w, near at 0
    minus_one_to_one,      // OpenGL clip volume −w ≤ z ≤ w, near at −w
};

// A right-handed camera that looks along `forward`. `up` need not be perpendicular to it. Angles are in radians,
// lengths in the scene's unit.
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

// Checks a camera. Errors: non-finite values; forward parallel to up; fov, aspect, height, near or far distance out of
// range.
[[nodiscard]] Result<void> validate(const Camera& camera);

// Returns the rotation from world directions to view directions (x right, y up, −z forward).
[[nodiscard]] glm::dmat3 world_to_view_rotation(const Camera& camera);

// Returns the matrix from view space to clip space, with y up. For Vulkan, flip the picture with a viewport of negative
// height, not the matrix.
[[nodiscard]] glm::dmat4 view_to_clip(const Camera& camera, DepthRange depth = DepthRange::reversed_zero_to_one);

// Returns view_to_clip · world_to_view with the translation. It rounds at large coordinates; frustum_of(Camera) does
// not.
[[nodiscard]] glm::dmat4 world_to_clip(const Camera& camera, DepthRange depth = DepthRange::reversed_zero_to_one);

// The order in which sixteen numbers list a matrix.
//
// - `columns`: column after column, for column vectors (GLM, OpenGL, Vulkan, Unity). DirectXMath's row vectors stored
//   row after row are the same sixteen numbers.
// - `rows`: row after row, for column vectors (Unreal's and many engines' transposed matrices).
enum class MatrixOrder : std::uint8_t { columns, rows };
[[nodiscard]] glm::dmat4 matrix_of(std::span<const float, 16> numbers, MatrixOrder order);
[[nodiscard]] glm::dmat4 matrix_of(std::span<const double, 16> numbers, MatrixOrder order);

// View volumes.

// A view volume: the exact set { x : dot(planes[i].normal, x − origin) + planes[i].offset ≥ 0 for all i < plane_count }
// of the stored numbers, taken as reals.
//
// It has six planes for a camera, five if far is infinite, and up to twelve for extruded shadow volumes. Normals have
// unit length up to rounding. A camera's planes are in the order left, right, bottom, top, near, far.
struct Frustum {
    static constexpr std::uint32_t kMaxPlanes = 12;
    glm::dvec3 origin{0.0};
    std::array<Plane, kMaxPlanes> planes{};
    std::uint32_t plane_count = 0;

    [[nodiscard]] std::span<const Plane> view() const { return {planes.data(), plane_count}; }
};

// Returns the frustum of a camera. Its planes are relative to camera.position, so precision does not suffer at large
// coordinates. Errors: as validate(Camera).
[[nodiscard]] Result<Frustum> frustum_of(const Camera& camera);

// Returns the frustum of any invertible matrix from positions relative to `origin` to clip space: perspective,
// orthographic, asymmetric, oblique, reversed-Z, infinite far. A depth plane at infinity is left out.
//
// Errors: non-finite entries, a singular matrix, an empty volume.
[[nodiscard]] Result<Frustum> frustum_of(const glm::dmat4& to_clip, DepthRange depth,
                                         const glm::dvec3& origin = glm::dvec3(0.0));

// Returns the corners relative to `origin`, near face first: left-bottom, right-bottom, left-top, right-top, then far.
// Errors: the frustum does not have a camera's six planes (far infinite, extruded).
[[nodiscard]] Result<std::array<glm::dvec3, 8>> frustum_corners(const Frustum& frustum);

// Tests whether the triangle, the exact convex hull of its three points, meets the closed frustum. Points are finite
// world positions. Exact: a filter in double decides most cases, rational clipping the rest.
[[nodiscard]] bool intersects(const Frustum& frustum, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

}  // namespace crofton
