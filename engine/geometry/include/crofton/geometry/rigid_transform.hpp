// SPDX-License-Identifier: MIT
// Where one body is, seen from another.
#pragma once
#include <crofton/core/error.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace crofton {

// x ↦ rotation · x + translation; `rotation` is orthonormal to 1e-6 (no scale, no shear; a reflection is allowed).
struct RigidTransform {
    glm::dmat3 rotation{1.0};
    glm::dvec3 translation{0.0};
};

// Errors: non-finite entries, a rotation that is none, a translation beyond 1e18.
[[nodiscard]] Result<void> validate(const RigidTransform& pose, std::uint64_t item = kNoItem);

// The point as all queries see it: this expression rounded in double, magnitudes below 1e-60 taken as 0. "Exact" for
// posed meshes means: for these points.
[[nodiscard]] glm::dvec3 transform(const RigidTransform& pose, const glm::dvec3& point);

[[nodiscard]] RigidTransform inverse(const RigidTransform& pose);
[[nodiscard]] RigidTransform operator*(const RigidTransform& outer, const RigidTransform& inner);

// The pose of b in a's frame, for poses of both in the world.
[[nodiscard]] RigidTransform relative(const RigidTransform& a, const RigidTransform& b);

}  // namespace crofton
