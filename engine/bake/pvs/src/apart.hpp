// SPDX-License-Identifier: MIT
// Is there a plane between two sets of points, with room on both sides?
#pragma once
#include <glm/vec3.hpp>
#include <span>

namespace crofton::pvs {

// True only if two parallel planes part the sets, more than `gap` from each other; gap ≥ 0. So the convex hulls are
// farther apart than that, but for the rounding of a difference of two dot products. False where they are not, and
// within 1e-6 of the distance where they are. Gilbert, Johnson, Keerthi 1988. `axis`: a direction to begin with, or 0;
// replaced by the one that was found. At least one point each.
[[nodiscard]] bool are_apart(std::span<const glm::dvec3> a, std::span<const glm::dvec3> b, double gap,
                             glm::dvec3& axis);

}  // namespace crofton::pvs
