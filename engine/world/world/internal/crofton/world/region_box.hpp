// SPDX-License-Identifier: MIT
// Computes the boxes of a region's objects that have a mesh or a shape.
#pragma once
#include <crofton/geometry/box.hpp>
#include <glm/vec3.hpp>

namespace crofton::world {

// Returns `box`, which contains what stands at `translation`, wider by what sums round if both are moved to an origin
// of which no coordinate is larger than max_origin.
[[nodiscard]] Obb region_box(const Obb& box, const glm::dvec3& translation, double max_origin);

}  // namespace crofton::world
