// SPDX-License-Identifier: MIT
// Bringing bounds up to date after moves.
#include <algorithm>
#include <bit>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/diagnostics.hpp>

#include "bounds.hpp"
#include "leaf_extents.hpp"
#include "rebuild.hpp"

namespace crofton::boxtree {

// Refit is to look at this slot and at its leaf.
void BoxTree::mark(std::uint32_t slot) {
    std::uint16_t& lanes = structure_.dirty_lanes[slot / kWidth];
    lanes = static_cast<std::uint16_t>(lanes | 1u << slot % kWidth);
}

void BoxTree::mark_changed(ItemId item) {
    if (!rebuild_) return;
    if (rebuild_->changed.size() <= item / 64) rebuild_->changed.resize(item / 64 + 1, 0);
    std::uint64_t& word = rebuild_->changed[item / 64];
    const std::uint64_t bit = std::uint64_t{1} << (item % 64);
    rebuild_->changed_count += (word & bit) == 0;
    ++rebuild_->new_changes;
    word |= bit;
}

void BoxTree::refit() {
    dirty_nodes_.clear();
    dirty_node_bits_.resize((structure_.nodes.size() + 63) / 64, 0);
    refit_leaves();
    // Level by level up; a node is done once all its dirty children are, for those above are asked again.
    while (!dirty_nodes_.empty()) {
        dirty_parents_.clear();
        for (const NodeId n : dirty_nodes_) dirty_node_bits_[n / 64] &= ~(std::uint64_t{1} << (n % 64));
        for (std::size_t i = 0; i < dirty_nodes_.size(); ++i) refit_node(dirty_nodes_[i]);
        dirty_nodes_.swap(dirty_parents_);
    }
    layers_changed_ = false;
    clear_dirty_bits();
}

// What has changed is remembered for two refits more.
void BoxTree::clear_dirty_bits() {
    if (dirty_list_.empty()) return;
    structure_.moved_two_refits_ago.swap(structure_.moved_last_refit);
    structure_.moved_last_refit.swap(structure_.dirty_lanes);
    std::fill(structure_.dirty_lanes.begin(), structure_.dirty_lanes.end(), std::uint16_t{0});
}

void BoxTree::list_dirty_leaves() {
    constexpr std::size_t kAtOnce = 16;
    const Vector<std::uint16_t>& dirty = structure_.dirty_lanes;
    dirty_list_.clear();
    for (std::size_t first = 0; first < dirty.size(); first += kAtOnce) {
        const std::size_t last = std::min(first + kAtOnce, dirty.size());
        std::uint32_t any = 0;
        for (std::size_t l = first; l < last; ++l) any |= dirty[l];
        if (any == 0) continue;
        for (std::size_t l = first; l < last; ++l)
            if (dirty[l]) dirty_list_.push_back(static_cast<LeafId>(l));
    }
}

// The bounds of leaves that have changed, into their parents' lanes.
void BoxTree::refit_leaves() {
    list_dirty_leaves();
    LeafExtent extents[kRefitBatch];
    for (std::size_t first = 0; first < dirty_list_.size(); first += kRefitBatch) {
        const std::size_t count = std::min(kRefitBatch, dirty_list_.size() - first);
        write_dirty_leaves(structure_, std::span(dirty_list_).subspan(first, count));
        leaf_extents(structure_.leaves.data(), std::span(dirty_list_).subspan(first, count), extents);
        for (std::size_t i = 0; i < count; ++i) {
            const LeafId l = dirty_list_[first + i];
            const Leaf& leaf = structure_.leaves[l];
            Aabb bounds = bounds_of(leaf, extents[i]);
            const glm::dvec3 size = bounds.is_empty() ? glm::dvec3(0.0) : bounds.max - bounds.min;
            // Far from its origin a leaf loses digits.
            if (double{leaf.reach} > 8.0 * (size.x + size.y + size.z)) {
                rewrite_leaf(structure_, l);
                bounds = bounds_of(leaf);
            }
            set_child(leaf.parent, leaf.lane_in_parent, bounds, dirty_nodes_);
        }
    }
}

// A node whose lanes are up to date, into its parent's lane.
void BoxTree::refit_node(NodeId n) {
    Aabb bounds = bounds_of(structure_.nodes[n]);
    const glm::dvec3 size = bounds.is_empty() ? glm::dvec3(0.0) : bounds.max - bounds.min;
    if (double{structure_.nodes[n].reach} > 8.0 * (size.x + size.y + size.z)) {
        refresh_node(structure_, n);
        bounds = bounds_of(structure_.nodes[n]);
    }
    const NodeId parent = structure_.nodes[n].parent;
    if (parent != kNone) set_child(parent, structure_.nodes[n].lane_in_parent, bounds, dirty_parents_);
}

// A child's bound, and layers if any have changed, into its lane; the node then is to be refitted. All lanes anew if
// its frame does not take the bound.
void BoxTree::set_child(NodeId n, unsigned lane, const Aabb& bounds, Vector<NodeId>& dirty) {
    if (!write_lane(structure_.nodes[n], lane, bounds)) refresh_node(structure_, n);
    if (layers_changed_) refresh_layers(structure_, n, lane);
    std::uint64_t& word = dirty_node_bits_[n / 64];
    const std::uint64_t bit = std::uint64_t{1} << (n % 64);
    if (word & bit) return;
    word |= bit;
    dirty.push_back(n);
}

}  // namespace crofton::boxtree
