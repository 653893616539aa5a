// SPDX-License-Identifier: MIT
#pragma once
#include <crofton/geometry/box.hpp>

namespace crofton::testing {

// An aligned cube.
[[nodiscard]] inline Obb box_at(const glm::dvec3& center, float half = 0.5f) {
    Obb box;
    box.center = center;
    box.half_extents = glm::vec3(half);
    return box;
}

}  // namespace crofton::testing
