// SPDX-License-Identifier: MIT
#include <crofton/boxtree/change_marks.hpp>

#include <algorithm>
#include <crofton/boxtree/items.hpp>
#include <utility>

namespace crofton::boxtree {

void ChangeMarks::Marks::clear() {
    for (const LeafId leaf : leaves) lanes[leaf] = 0;
    leaves.clear();
}

void ChangeMarks::reset(std::size_t leaves) {
    for (Marks* marks : {&dirty_, &last_refit_, &two_refits_ago_}) {
        marks->clear();
        marks->lanes.resize(leaves, 0);
    }
}

void ChangeMarks::reserve(std::size_t leaves) {
    for (Marks* marks : {&dirty_, &last_refit_, &two_refits_ago_}) marks->lanes.reserve(leaves);
}

void ChangeMarks::add_leaf() {
    for (Marks* marks : {&dirty_, &last_refit_, &two_refits_ago_}) {
        make_room_for(marks->lanes, 1);
        marks->lanes.push_back(0);
    }
}

// Neighbours in the list often share a leaf: their bits are collected and written once.
void ChangeMarks::mark(std::span<const std::uint32_t> slots) {
    if (slots.empty()) return;
    LeafId leaf = slots[0] / kWidth;
    std::uint32_t lanes = 0;
    for (const std::uint32_t slot : slots) {
        if (slot / kWidth != leaf) {
            add(leaf, lanes);
            leaf = slot / kWidth;
            lanes = 0;
        }
        lanes |= 1u << slot % kWidth;
    }
    add(leaf, lanes);
}

void ChangeMarks::list_dirty_leaves(Vector<LeafId>& leaves) const {
    constexpr std::size_t kFew = 32;  // one leaf in so many: sorting them costs less than looking at all
    leaves.clear();
    if (dirty_.leaves.size() < dirty_.lanes.size() / kFew) {
        leaves.assign(dirty_.leaves.begin(), dirty_.leaves.end());
        std::sort(leaves.begin(), leaves.end());
        return;
    }
    if (dirty_.leaves.empty()) return;
    for (LeafId leaf = 0; leaf < dirty_.lanes.size(); ++leaf)
        if (dirty_.lanes[leaf] != 0) leaves.push_back(leaf);
}

void ChangeMarks::finish_refit() {
    std::swap(two_refits_ago_, last_refit_);
    std::swap(last_refit_, dirty_);
    dirty_.clear();
}

}  // namespace crofton::boxtree
