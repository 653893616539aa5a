// SPDX-License-Identifier: MIT
// Bounds of the boxes in a leaf.
#pragma once
#include <hwy/cache_control.h>
#include <algorithm>
#include <span>

#include "bound_blocks.hpp"
#include "box_lanes.hpp"

namespace crofton::collide {

// Puts the bounds of up to sixteen boxes, around `origin`; returns the lanes that need a closer look, as bound_boxes().
// Lanes beyond are anything. Asks the memory for the boxes of `later`.
inline std::uint32_t bound_items(std::span<const Obb> boxes, std::span<const std::uint32_t> items,
                                 std::span<const std::uint32_t> later, const glm::dvec3& origin, BoundBlock& bounds) {
    BoxBlock block;
    for (std::size_t lane = 0; lane < kBoxBlock; ++lane) {
        const Obb& box = boxes[items[std::min(lane, items.size() - 1)]];
        if (lane < later.size()) {
            const char* const ahead = reinterpret_cast<const char*>(&boxes[later[lane]]);
            hwy::Prefetch(ahead);
            hwy::Prefetch(ahead + sizeof(Obb) - 1);
        }
        put_center(box.center - origin, lane, block);
        put_shape(box, lane, block);
    }
    return bound_boxes(block, bounds) & ((1u << items.size()) - 1u);
}

[[nodiscard]] inline LaneBounds lane_of(const BoundBlock& block, std::size_t lane) {
    LaneBounds bounds;
    for (int i = 0; i < 3; ++i) {
        bounds.low[i] = block.low[i][lane];
        bounds.high[i] = block.high[i][lane];
    }
    return bounds;
}

}  // namespace crofton::collide
