// SPDX-License-Identifier: MIT
// Affine maps in double.
#pragma once
#include <crofton/core/error.hpp>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace crofton {

// x ↦ linear · x + translation: any rotation, scale, shear or reflection; translation in double.
struct Transform {
    glm::dmat3 linear{1.0};
    glm::dvec3 translation{0.0};
};

// Returns outer ∘ inner: applies `inner` first.
[[nodiscard]] Transform operator*(const Transform& outer, const Transform& inner);
[[nodiscard]] glm::dvec3 operator*(const Transform& transform, const glm::dvec3& point);

// Returns a transform that scales, then rotates, then translates.
//
// A quaternion within 1 % of unit length is normalised: one stored in normalised bytes is off by at most sqrt(4)/254 =
// 0.8 %. Errors: as validate; any other quaternion (invalid_argument).
[[nodiscard]] Result<Transform> from_trs(const glm::dvec3& translation, const glm::dquat& rotation,
                                         const glm::dvec3& scale);

// Returns the upper three rows of a column-vector matrix. Errors: as validate; a last row other than (0, 0, 0, 1).
[[nodiscard]] Result<Transform> from_matrix(const glm::dmat4& matrix);

// Checks a transform. Any scale is valid, zero included. Errors: NaN or infinite entries; a column longer than 1e15; a
// translation beyond 1e15. The error's item is `item`.
[[nodiscard]] Result<void> validate(const Transform& transform, std::uint64_t item = kNoItem);

// Tests whether the linear part is zero, so that every point has the same image. Engines hide the objects under a node
// with such a transform.
[[nodiscard]] bool maps_to_point(const Transform& transform);

}  // namespace crofton
