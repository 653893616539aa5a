// SPDX-License-Identifier: MIT
// CullOptions::candidate_mask as bits of a tree's slots. With them a query tests no item outside the mask, and skips
// nodes without candidates.
#include <algorithm>
#include <bit>
#include <crofton/boxtree/structure.hpp>

#include "tree/query.hpp"

namespace crofton::cull {
namespace {

// Calls visit(item) for each item below `items` that the set has.
template <class Visit>
void for_each_candidate(std::span<const std::uint64_t> set, std::size_t items, const Visit& visit) {
    for (std::size_t first = 0; first < items; first += 64) {
        std::uint64_t bits = first / 64 < set.size() ? set[first / 64] : ~std::uint64_t{0};
        if (items - first < 64) bits &= (std::uint64_t{1} << (items - first)) - 1;
        for (; bits != 0; bits &= bits - 1)
            visit(static_cast<ItemId>(first + static_cast<std::size_t>(std::countr_zero(bits))));
    }
}

// std::popcount calls a table-driven function on instruction sets without popcount.
std::size_t bit_count(std::uint64_t bits) {
    bits -= bits >> 1 & 0x5555555555555555u;
    bits = (bits & 0x3333333333333333u) + (bits >> 2 & 0x3333333333333333u);
    return ((bits + (bits >> 4)) & 0x0f0f0f0f0f0f0f0fu) * 0x0101010101010101u >> 56;
}

std::size_t count_candidates(std::span<const std::uint64_t> set, std::size_t items) {
    std::size_t count = items - std::min(items, 64 * set.size());
    for (const std::uint64_t word : set) count += bit_count(word);
    return count;
}

}  // namespace

// True if the bits are those of the options' set and this structure. Those of few items are made at once: it takes no
// longer than looking up what the view finds. Those of many are made when queries among the same set have looked up as
// many items one by one as there are slots. So making them at most doubles what a set costs that is soon replaced, and
// an eye that stays in its cell pays once.
bool Query::has_candidate_slots(const boxtree::Structure& structure) {
    constexpr std::size_t kFew = 8;  // one item in so many
    VisibleSet::CandidateSlots& slots = visible_.candidate_slots_;
    const std::span<const std::uint64_t> set = options_.candidate_mask;
    const std::size_t slot_count = structure.slot_items().size();
    const boxtree::SlotsVersion version = structure.slots_version();
    const bool same = slots.structure == version.structure && slots.changes == version.changes &&
                      std::equal(set.begin(), set.end(), slots.set.begin(), slots.set.end());
    if (!same) {
        slots.structure = version.structure, slots.changes = version.changes;
        slots.set.assign(set.begin(), set.end());
        slots.leaves.resize(structure.leaves().size());
        slots.nodes.resize(structure.nodes().size());
        slots.made = false;
        slots.looked_up = kFew * count_candidates(set, structure.item_slots().size()) <= slot_count ? slot_count : 0;
    }
    if (!slots.made && slots.looked_up >= slot_count) make_candidate_slots(structure);
    return slots.made;
}

void Query::make_candidate_slots(const boxtree::Structure& structure) {
    VisibleSet::CandidateSlots& slots = visible_.candidate_slots_;
    slots.made = true;
    std::fill(slots.leaves.begin(), slots.leaves.end(), std::uint16_t{0});
    const std::span<const std::uint32_t> item_slots = structure.item_slots();
    for_each_candidate(options_.candidate_mask, item_slots.size(), [&](ItemId item) {
        const std::uint32_t slot = item_slots[item];
        if (slot == boxtree::kNone) return;
        std::uint16_t& bits = slots.leaves[slot / boxtree::kWidth];
        bits = static_cast<std::uint16_t>(bits | 1u << slot % boxtree::kWidth);
    });
    mark_below(structure.nodes(), 0, slots.leaves, slots.nodes);
}

// Marks the children with slots that the set has; returns whether there are any. As deep as the tree is.
bool Query::mark_below(std::span<const boxtree::Node> nodes, boxtree::NodeId n, std::span<const std::uint16_t> leaves,
                       std::span<std::uint16_t> marks) {
    std::uint32_t bits = 0;
    for (std::uint32_t lane = 0; lane < nodes[n].count; ++lane) {
        const std::uint32_t child = nodes[n].child[lane];
        const bool any = child & boxtree::kLeafBit ? leaves[child & ~boxtree::kLeafBit] != 0
                                                   : mark_below(nodes, child, leaves, marks);
        bits |= std::uint32_t{any} << lane;
    }
    marks[n] = static_cast<std::uint16_t>(bits);
    return bits != 0;
}

}  // namespace crofton::cull
