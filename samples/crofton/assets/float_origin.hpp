// SPDX-License-Identifier: MIT
// Where floats that are relative to an origin are fine enough.
#pragma once
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vec3.hpp>

namespace crofton::assets {

// Returns an origin for the vertices of a box: 0, unless the box is so far out that floats would be off by more than a
// millionth of its size. Its coordinates are whole, so that vertices which are floats stay as they are.
[[nodiscard]] inline glm::dvec3 float_origin(const glm::dvec3& low, const glm::dvec3& high) {
    const auto greatest = [](const glm::dvec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); };
    const glm::dvec3 middle = 0.5 * (low + high);
    return greatest(middle) > 16.0 * greatest(high - low) && greatest(middle) < 1e15 ? glm::round(middle)
                                                                                     : glm::dvec3(0.0);
}

}  // namespace crofton::assets
