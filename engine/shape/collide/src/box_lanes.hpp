// SPDX-License-Identifier: MIT
// Puts boxes into the lanes of a block.
#pragma once
#include <crofton/collide/box_block.hpp>
#include <crofton/geometry/box.hpp>

namespace crofton::collide {

inline void put_shape(const Obb& box, std::size_t lane, BoxBlock& block) {
    for (int k = 0; k < 3; ++k) {
        block.half[k][lane] = box.half_extents[k];
        for (int i = 0; i < 3; ++i) block.axes[k][i][lane] = box.axes[k][i];
    }
}

inline void put_center(const glm::dvec3& center, std::size_t lane, BoxBlock& block) {
    for (int i = 0; i < 3; ++i) block.center[i][lane] = static_cast<float>(center[i]);
}

}  // namespace crofton::collide
