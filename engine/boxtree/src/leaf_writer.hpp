// SPDX-License-Identifier: MIT
// Boxes into the lanes of leaves, and the check that they may go there: in vectors, sixteen at a time.
#pragma once
#include <crofton/boxtree/layout.hpp>
#include <crofton/geometry/box.hpp>
#include <cstddef>
#include <span>

namespace crofton::boxtree {

// Lane i < count of each of the leaves that `ids` names gets the box of its item, slot_items[16 · leaf + i]: the very
// numbers of write_lane (bounds.hpp); the reach is that of these boxes. Returns how many leaves from the first on have
// been written; the next, if there is one, has a box that does not fit into its frame, and lanes that are good for
// nothing.
[[nodiscard]] std::size_t write_lanes(Leaf* leaves, std::span<const LeafId> ids, const ItemId* slot_items,
                                      const Obb* boxes);

// How many boxes from the first on certainly pass validate(Obb). Where a box is within float rounding of what is
// allowed, or a share of 15 others beside one, the answer may be too small.
[[nodiscard]] std::size_t count_certainly_valid(const Obb* boxes, std::size_t count);

}  // namespace crofton::boxtree
