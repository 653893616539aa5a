// SPDX-License-Identifier: MIT
// A view volume as half-spaces around an origin: what culling tests against.
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/plane.hpp>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <span>

namespace crofton {

// The exact set { x : dot(planes[i].normal, x − origin) + planes[i].offset ≥ 0 for all i < plane_count } of the stored
// numbers, taken as reals. Six planes for a camera, five when far is infinite, up to twelve for extruded shadow
// volumes. Normals are unit length up to rounding. Order for cameras: left, right, bottom, top, near, far.
struct Frustum {
    static constexpr std::uint32_t kMaxPlanes = 12;
    glm::dvec3 origin{0.0};
    std::array<Plane, kMaxPlanes> planes{};
    std::uint32_t plane_count = 0;

    [[nodiscard]] std::span<const Plane> view() const { return {planes.data(), plane_count}; }
};

// From parameters: planes relative to camera.position, so nothing is lost at large coordinates. Errors: as
// validate(Camera).
[[nodiscard]] Result<Frustum> frustum_of(const Camera& camera);

// From any invertible matrix that takes positions relative to `origin` to clip space: perspective, orthographic,
// asymmetric, oblique, reversed-Z, infinite far. A depth plane at infinity is left out. Errors: non-finite entries,
// singular matrix, a volume that is empty.
[[nodiscard]] Result<Frustum> frustum_of(const glm::dmat4& to_clip, DepthRange depth,
                                         const glm::dvec3& origin = glm::dvec3(0.0));

// Corners relative to `origin`, near face first: left-bottom, right-bottom, left-top, right-top, then far.
// Errors: not a camera's six planes (far infinite, extruded).
[[nodiscard]] Result<std::array<glm::dvec3, 8>> frustum_corners(const Frustum& frustum);

// True iff the triangle, taken as the exact convex hull of its three points, meets the closed frustum. Exact: decided
// by a filter in double and by rational clipping where that cannot tell. Points are world positions, finite.
[[nodiscard]] bool intersects(const Frustum& frustum, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

}  // namespace crofton
