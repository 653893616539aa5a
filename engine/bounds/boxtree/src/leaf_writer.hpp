// SPDX-License-Identifier: MIT
// Boxes into the lanes of leaves, in vectors of sixteen.
#pragma once
#include <crofton/boxtree/layout.hpp>
#include <crofton/geometry/box.hpp>
#include <cstddef>
#include <span>

namespace crofton::boxtree {

// Lane i < count of each of the leaves that `ids` names gets the box of its item, slot_items[16 · leaf + i]. The
// numbers are those of write_lane (bounds.hpp); `l1_radius` is that of these boxes. Returns how many leaves from the
// first on have been written. The next, if there is one, has a box that does not fit into its frame; its lanes are
// undefined.
[[nodiscard]] std::size_t write_lanes(Leaf* leaves, std::span<const LeafId> ids, const ItemId* slot_items,
                                      const Obb* boxes);

}  // namespace crofton::boxtree
