// SPDX-License-Identifier: MIT
// Orientation of transforms: signs and directions that rounding must not change.
#pragma once
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace crofton::occlude {

// The sign of the determinant, exactly. Requires finite numbers, of any size: orientation() is exact within 1e±70
// alone.
[[nodiscard]] int sign_of_determinant(const glm::dmat3& m);

// Along a × b, with length 1, however small the angle between them. Each component is within 2^-49 of itself, unless it
// is below 2^-900. NaN if a × b is 0. Requires finite numbers.
[[nodiscard]] glm::dvec3 direction_across(const glm::dvec3& a, const glm::dvec3& b);

}  // namespace crofton::occlude
