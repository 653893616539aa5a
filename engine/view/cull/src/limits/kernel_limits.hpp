// SPDX-License-Identifier: MIT
// Draw limits as the vector kernels read them: plain numbers, no GLM.
#pragma once
#include <crofton/boxtree/layout.hpp>

namespace crofton::cull {

// Squares of limits; [0] for all items, [1] for those that hysteresis keeps longer. A limit that is off is infinite, or
// 0 for the least radius. A limit whose square is no float is off in [1], where it would drop, and in [0] keeps
// nothing.
struct KernelLimits {
    double eye[3];
    float radii[2];
    float least_radius[2];
    bool has_layers, has_items;
    // Returns the squared distance of an item in these layers, or of any item in some of them. NaN if floats cannot
    // square it.
    float (*layer_square)(const void* limits, std::uint32_t common_layers, bool least_of_all);
    const void* limits;
    float longer_square;
    const boxtree::NodeRadii* radii_below;  // by NodeId
};

}  // namespace crofton::cull
