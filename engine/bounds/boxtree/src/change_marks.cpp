// SPDX-License-Identifier: MIT
#include <crofton/boxtree/change_marks.hpp>

#include <algorithm>
#include <crofton/boxtree/items.hpp>

namespace crofton::boxtree {

void ChangeMarks::reset(std::size_t leaves) {
    for (Vector<std::uint16_t>* lanes : {&dirty_lanes_, &moved_last_refit_, &moved_two_refits_ago_})
        lanes->assign(leaves, 0);
}

void ChangeMarks::add_leaf() {
    for (Vector<std::uint16_t>* lanes : {&dirty_lanes_, &moved_last_refit_, &moved_two_refits_ago_}) {
        make_room_for(*lanes, 1);
        lanes->push_back(0);
    }
}

// Neighbours in the list often share a leaf: their bits are collected and written once.
void ChangeMarks::mark(std::span<const std::uint32_t> slots) {
    std::uint16_t* dirty = dirty_lanes_.data();
    LeafId leaf = 0;
    std::uint32_t lanes = 0;
    for (const std::uint32_t slot : slots) {
        if (slot / kWidth != leaf) {
            dirty[leaf] = static_cast<std::uint16_t>(dirty[leaf] | lanes);
            leaf = slot / kWidth;
            lanes = 0;
        }
        lanes |= 1u << slot % kWidth;
    }
    if (lanes) dirty[leaf] = static_cast<std::uint16_t>(dirty[leaf] | lanes);
}

void ChangeMarks::list_dirty_leaves(Vector<LeafId>& leaves) const {
    constexpr std::size_t kAtOnce = 16;
    leaves.clear();
    for (std::size_t first = 0; first < dirty_lanes_.size(); first += kAtOnce) {
        const std::size_t last = std::min(first + kAtOnce, dirty_lanes_.size());
        std::uint32_t any = 0;
        for (std::size_t l = first; l < last; ++l) any |= dirty_lanes_[l];
        if (any == 0) continue;
        for (std::size_t l = first; l < last; ++l)
            if (dirty_lanes_[l]) leaves.push_back(static_cast<LeafId>(l));
    }
}

void ChangeMarks::finish_refit() {
    moved_two_refits_ago_.swap(moved_last_refit_);
    moved_last_refit_.swap(dirty_lanes_);
    std::fill(dirty_lanes_.begin(), dirty_lanes_.end(), std::uint16_t{0});
}

}  // namespace crofton::boxtree
