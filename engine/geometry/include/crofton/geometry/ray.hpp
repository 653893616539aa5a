// SPDX-License-Identifier: MIT
// A ray or segment in space.
#pragma once
#include <crofton/core/error.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>

namespace crofton {

// The points origin + t · direction, 0 ≤ t ≤ max_t; a segment from p to q is {p, q − p, 1}. `direction` need not be of
// unit length, max_t may be infinite. A ray that fails validate hits nothing.
struct Ray {
    glm::dvec3 origin{0.0}, direction{0.0, 0.0, 1.0};
    double max_t = std::numeric_limits<double>::infinity();
};

// Errors: an origin or direction that is not finite; no direction; max_t negative or NaN.
[[nodiscard]] Result<void> validate(const Ray& ray, std::uint64_t item = kNoItem);

}  // namespace crofton
