// SPDX-License-Identifier: MIT
// The least sphere around points.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/geometry/shapes.hpp>
#include <span>

namespace crofton::fit {

// V, F and M of a sphere grow with its radius alone: the least sphere is the best by every criterion. Contains every
// point, by distances in double, and is larger than the least by rounding only (1e-9 of it at worst). Exact up to that:
// the least sphere around at most four points that hold all others, found by adding the farthest point outside until
// there is none; each step is linear in the points, and a dozen steps are usual. Errors: as fit_obb.
[[nodiscard]] Result<Sphere> minimal_sphere(std::span<const glm::dvec3> points);

}  // namespace crofton::fit
