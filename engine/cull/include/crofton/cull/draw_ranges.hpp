// SPDX-License-Identifier: MIT
// Visible items as a bit set, or as runs that one draw call takes.
#pragma once
#include <crofton/boxtree/layout.hpp>
#include <crofton/core/memory.hpp>
#include <cstddef>
#include <cstdint>
#include <span>

namespace crofton::cull {

// Items [first, first + count).
struct ItemRange {
    boxtree::ItemId first = 0;
    std::uint32_t count = 0;
};

// Bit id % 64 of word id / 64 for each id; `bits` is made as long as `items` needs. Requires ids below `items`,
// each once.
void to_bits(std::span<const boxtree::ItemId> ids, std::size_t items, Vector<std::uint64_t>& bits);

// The runs of set bits, ascending; runs that are at most `max_gap` items apart become one (drawing a few items in vain
// is cheaper than another draw call). Runs are long where ids follow the tree's order: number the instances by
// BoxTree::slot_items().
void merge_ranges(std::span<const std::uint64_t> bits, std::uint32_t max_gap, Vector<ItemRange>& ranges);

}  // namespace crofton::cull
