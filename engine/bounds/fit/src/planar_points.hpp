// SPDX-License-Identifier: MIT
// Checks and preparation of points, shared by all fits in the plane.
#pragma once
#include <crofton/core/error.hpp>
#include <glm/vec2.hpp>
#include <span>

namespace crofton::fit {

// Errors: no points; a coordinate that is NaN, infinite or beyond kMaxCoordinate, by index.
[[nodiscard]] Result<void> check_planar(std::span<const glm::dvec2> points);

}  // namespace crofton::fit
