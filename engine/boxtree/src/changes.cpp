// SPDX-License-Identifier: MIT
// Moving, inserting and removing items.
#include <hwy/cache_control.h>
#include <algorithm>
#include <array>
#include <bit>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/valid_boxes.hpp>

#include "bounds.hpp"
#include "leaf_writer.hpp"
#include "rebuild.hpp"

namespace crofton::boxtree {

namespace {

constexpr std::size_t kMaxItems = std::size_t{1} << 30;
// Scattered items wait for memory: slots and boxes are asked for so many items ahead of their use, then leaves.
constexpr std::size_t kAhead = 32, kNear = 12;

// By an eighth where there is no room: a tree that is loaded and then changes a little does not double its memory.
template <class T>
void grow_for_one(Vector<T>& items) {
    if (items.size() == items.capacity()) items.reserve(items.size() + items.size() / 8 + 16);
}

template <class T>
void prefetch_all(const T& value) {
    for (std::size_t at = 0; at < sizeof(T); at += 64) hwy::Prefetch(reinterpret_cast<const char*>(&value) + at);
}

}  // namespace

Result<void> BoxTree::move(ItemId item, const Obb& box) {
    return move(std::span(&item, 1), std::span(&box, 1));
}

Result<void> BoxTree::move(std::span<const ItemId> items, std::span<const Obb> boxes) {
    if (items.size() != boxes.size())
        return fail(ErrorCode::invalid_argument, kNoItem, "box tree: as many boxes as items are needed");
    if (auto valid = find_moved(items, boxes); !valid) return valid;
    mark_moved();
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (i + kAhead < items.size()) prefetch_all(boxes_[items[i + kAhead]]);
        if (i + kNear < items.size() && has_few_changes(moved_slots_[i + kNear] / kWidth))
            prefetch_all(structure_.leaves[moved_slots_[i + kNear] / kWidth]);
        boxes_[items[i]] = boxes[i];
        const LeafId leaf = moved_slots_[i] / kWidth;
        if (has_few_changes(leaf) && !write_lane(structure_.leaves[leaf], moved_slots_[i] % kWidth, boxes[i]))
            rewrite_leaf(structure_, leaf);
    }
    if (rebuild_)
        for (const ItemId item : items) mark_changed(item);
    return {};
}

bool BoxTree::has_few_changes(LeafId leaf) const {
    return at_most_three_bits(structure_.dirty_lanes[leaf]);
}

// The items' slots, if all is well.
Result<void> BoxTree::find_moved(std::span<const ItemId> items, std::span<const Obb> boxes) {
    const std::uint32_t* slots = structure_.item_slots.data();
    moved_slots_.resize(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (i + kAhead < items.size() && items[i + kAhead] < boxes_.size()) hwy::Prefetch(slots + items[i + kAhead]);
        if (!is_present(items[i])) return check_item(items[i]);
        moved_slots_[i] = slots[items[i]];
    }
    for (std::size_t i = 0; i < boxes.size();) {
        i += count_certainly_valid(&boxes[i], boxes.size() - i);
        for (const std::size_t end = std::min(boxes.size(), i + kWidth); i < end; ++i)
            if (auto valid = crofton::validate(boxes[i], items[i]); !valid) return valid;
    }
    return {};
}

// Neighbours often share a leaf: theirs are put down at once.
void BoxTree::mark_moved() {
    std::uint16_t* dirty = structure_.dirty_lanes.data();
    LeafId leaf = 0;
    std::uint32_t lanes = 0;
    for (const std::uint32_t slot : moved_slots_) {
        if (slot / kWidth != leaf) {
            dirty[leaf] = static_cast<std::uint16_t>(dirty[leaf] | lanes);
            leaf = slot / kWidth;
            lanes = 0;
        }
        lanes |= 1u << slot % kWidth;
    }
    if (lanes) dirty[leaf] = static_cast<std::uint16_t>(dirty[leaf] | lanes);
}

Result<void> BoxTree::set_layer_mask(ItemId item, std::uint32_t layer_mask) {
    if (is_detached(item)) {
        layer_masks_[item] = layer_mask;
        detached_layers_ &= layer_mask;
        return {};
    }
    if (auto known = check_item(item); !known) return known;
    layer_masks_[item] = layer_mask;
    const std::uint32_t slot = structure_.item_slots[item];
    write_layers(structure_.leaves[slot / kWidth], slot % kWidth, layer_mask);
    layers_changed_ = true;
    mark(slot);
    mark_changed(item);
    return {};
}

Result<void> BoxTree::remove(ItemId item) {
    if (is_detached(item)) {
        set_detached(item, false);
        free_items_.push_back(item);
        return {};
    }
    if (auto known = check_item(item); !known) return known;
    vacate(item);
    free_items_.push_back(item);
    mark_changed(item);
    return {};
}

// The leaf's last item moves into the gap.
void BoxTree::vacate(ItemId item) {
    const std::uint32_t slot = structure_.item_slots[item];
    const LeafId l = slot / kWidth;
    Leaf& leaf = structure_.leaves[l];
    const std::uint32_t last = --leaf.count;
    structure_.leaf_counts[l] = static_cast<std::uint8_t>(leaf.count);
    const ItemId moved = structure_.slot_items[l * kWidth + last];
    if (moved != item) {
        structure_.slot_items[slot] = moved;
        structure_.item_slots[moved] = slot;
        write_item(structure_, moved);
    }
    clear_lane(leaf, last);
    structure_.slot_items[l * kWidth + last] = kNone;
    structure_.item_slots[item] = kNone;
    invalidate_item_count(leaf.parent);
    layers_changed_ = true;
    mark(slot);
}

// An id for it, that of a removed item if there is one.
Result<ItemId> BoxTree::new_item(const Obb& box, std::uint32_t layer_mask) {
    if (free_items_.empty()) {
        const auto item = static_cast<ItemId>(boxes_.size());
        if (item >= kMaxItems) return fail(ErrorCode::out_of_range, item, "box tree: more than 2^30 boxes");
        grow_for_one(boxes_);
        grow_for_one(layer_masks_);
        grow_for_one(structure_.item_slots);
        boxes_.push_back(box);
        layer_masks_.push_back(layer_mask);
        structure_.item_slots.push_back(kNone);
        return item;
    }
    const ItemId item = free_items_.back();
    free_items_.pop_back();
    boxes_[item] = box;
    layer_masks_[item] = layer_mask;
    return item;
}

Result<ItemId> BoxTree::insert(const Obb& box, std::uint32_t layer_mask) {
    if (auto valid = crofton::validate(box, free_items_.empty() ? boxes_.size() : free_items_.back()); !valid)
        return tl::unexpected(valid.error());
    auto item = new_item(box, layer_mask);
    if (!item) return item;
    mark_changed(*item, true);
    place(*item);
    return item;
}

// Finds a slot for an item that has none.
void BoxTree::place(ItemId item) {
    const Obb& box = boxes_[item];
    const Aabb bounds = aabb_of(box);
    if (structure_.nodes[0].count == 0) add_child(0, add_leaf() | kLeafBit);
    LeafId l = best_leaf(bounds);
    if (structure_.leaves[l].count == kWidth) split_leaf(l);  // half of its lanes are free then
    Leaf& leaf = structure_.leaves[l];
    const std::uint32_t slot = l * kWidth + leaf.count++;
    structure_.leaf_counts[l] = static_cast<std::uint8_t>(leaf.count);
    structure_.slot_items[slot] = item;
    structure_.item_slots[item] = slot;
    write_item(structure_, item);
    invalidate_item_count(leaf.parent);
    refresh_path(leaf.parent);
}

LeafId BoxTree::add_leaf() {
    const auto fresh = static_cast<LeafId>(structure_.leaves.size());
    structure_.leaves.emplace_back();
    clear(structure_.leaves[fresh]);
    structure_.leaf_counts.push_back(0);
    structure_.slot_items.resize(structure_.slot_items.size() + kWidth, kNone);
    structure_.dirty_lanes.push_back(0);
    structure_.moved_last_refit.push_back(0);
    structure_.moved_two_refits_ago.push_back(0);
    return fresh;
}

// Down from the root into the child whose criterion grows least.
LeafId BoxTree::best_leaf(const Aabb& bounds) const {
    const Cost cost(criterion_);
    const auto of = [&](const Aabb& b) {
        return b.is_empty() ? 0.0 : cost.of(b.max.x - b.min.x, b.max.y - b.min.y, b.max.z - b.min.z);
    };
    NodeId n = 0;
    for (;;) {
        const Node& node = structure_.nodes[n];
        unsigned best = 0;
        double best_growth = std::numeric_limits<double>::infinity(), best_size = best_growth;
        for (unsigned lane = 0; lane < node.count; ++lane) {
            const Aabb old = bounds_of_lane(node, lane);
            Aabb grown = bounds;
            if (!old.is_empty()) grown.include(old);
            const double size = of(old), growth = of(grown) - size;
            if (growth < best_growth || (growth == best_growth && size < best_size)) {
                best = lane;
                best_growth = growth;
                best_size = size;
            }
        }
        if (node.child[best] & kLeafBit) return node.child[best] & ~kLeafBit;
        n = node.child[best];
    }
}

// Half of a full leaf's items go to a new leaf beside it.
void BoxTree::split_leaf(LeafId l) {
    BuildItem items[kWidth];
    for (unsigned lane = 0; lane < kWidth; ++lane) {
        const Obb& box = boxes_[structure_.slot_items[l * kWidth + lane]];
        items[lane] = {};
        for (int j = 0; j < 3; ++j) {
            const auto center = static_cast<float>(box.center[j] - structure_.leaves[l].origin[j]);
            items[lane].extreme[j] = -center;
            items[lane].extreme[4 + j] = center;
        }
        items[lane].set_id(structure_.slot_items[l * kWidth + lane]);
    }
    const Children halves = divide(items, {0, kWidth}, kWidth / 2, Cost(criterion_));
    const LeafId fresh = add_leaf();
    const NodeId parent = structure_.leaves[l].parent;
    const std::uint32_t lane_in_parent = structure_.leaves[l].lane_in_parent;
    const LeafId both[2] = {l, fresh};
    for (unsigned side = 0; side < 2; ++side) {
        Leaf& leaf = structure_.leaves[both[side]];
        clear(leaf);
        leaf.parent = parent;
        leaf.lane_in_parent = lane_in_parent;
        for (unsigned lane = 0; lane < kWidth; ++lane) structure_.slot_items[both[side] * kWidth + lane] = kNone;
        for (std::uint32_t i = halves.ranges[side].begin; i < halves.ranges[side].end; ++i) {
            const std::uint32_t slot = both[side] * kWidth + leaf.count++;
            structure_.slot_items[slot] = items[i].id();
            structure_.item_slots[items[i].id()] = slot;
        }
        structure_.leaf_counts[both[side]] = static_cast<std::uint8_t>(leaf.count);
        write_leaf_layers(structure_, both[side]);
        rewrite_leaf(structure_, both[side]);
    }
    add_child(parent, fresh | kLeafBit);
    refresh_path(structure_.leaves[l].parent);
    refresh_path(structure_.leaves[fresh].parent);
}

void BoxTree::link(NodeId parent, unsigned lane, std::uint32_t child) {
    structure_.nodes[parent].child[lane] = child;
    if (child & kLeafBit) {
        structure_.leaves[child & ~kLeafBit].parent = parent;
        structure_.leaves[child & ~kLeafBit].lane_in_parent = lane;
    } else {
        structure_.nodes[child].parent = parent;
        structure_.nodes[child].lane_in_parent = lane;
        structure_.nodes[parent].only_leaves = 0;
    }
}

void BoxTree::add_child(NodeId parent, std::uint32_t child) {
    while (structure_.nodes[parent].count == kWidth) parent = split_node(parent);
    Node& node = structure_.nodes[parent];
    node.count++;
    link(parent, node.count - 1, child);
    // No longer one run of leaves, here and above.
    for (NodeId n = parent; n != kNone; n = structure_.nodes[n].parent) structure_.ranges[n] = {};
}

// Half of a full node's children go to a new node; returns the one of the two that the caller may add to. Splitting the
// root makes a new level below node 0.
NodeId BoxTree::split_node(NodeId n) {
    BuildItem items[kWidth];
    std::array<std::uint32_t, kWidth> children;
    for (unsigned lane = 0; lane < kWidth; ++lane) {
        const Node& node = structure_.nodes[n];
        items[lane] = {};
        for (unsigned j = 0; j < 3; ++j) {
            items[lane].extreme[j] = -static_cast<float>(low_of(node, lane, j));
            items[lane].extreme[4 + j] = static_cast<float>(high_of(node, lane, j));
        }
        items[lane].set_id(lane);
        children[lane] = node.child[lane];
    }
    const Children halves = divide(items, {0, kWidth}, kWidth / 2, Cost(criterion_));
    const auto make = [&](unsigned side, NodeId into, NodeId parent, unsigned lane_in_parent) {
        clear(structure_.nodes[into]);
        structure_.ranges[into] = {};
        structure_.nodes[into].parent = parent;
        structure_.nodes[into].lane_in_parent = lane_in_parent;
        structure_.nodes[into].only_leaves = 1;
        for (std::uint32_t i = halves.ranges[side].begin; i < halves.ranges[side].end; ++i)
            link(into, structure_.nodes[into].count++, children[items[i].id()]);
    };
    const auto fresh = static_cast<NodeId>(structure_.nodes.size());
    if (n == 0) {
        structure_.nodes.resize(fresh + 2);
        structure_.ranges.resize(fresh + 2);
        make(0, fresh, 0, 0);
        make(1, fresh + 1, 0, 1);
        clear(structure_.nodes[0]);
        structure_.ranges[0] = {};
        link(0, 0, fresh);
        link(0, 1, fresh + 1);
        structure_.nodes[0].count = 2;
        ++structure_.height;
        refresh_node(structure_, fresh);
        refresh_node(structure_, fresh + 1);
        refresh_node(structure_, 0);
        return fresh;
    }
    structure_.nodes.emplace_back();
    structure_.ranges.emplace_back();
    const NodeId parent = structure_.nodes[n].parent;
    const unsigned lane = structure_.nodes[n].lane_in_parent;
    make(0, n, parent, lane);
    make(1, fresh, parent, 0);
    refresh_node(structure_, n);
    refresh_node(structure_, fresh);
    add_child(parent, fresh);
    refresh_path(structure_.nodes[n].parent);
    refresh_path(structure_.nodes[fresh].parent);
    return n;
}

void BoxTree::refresh_path(NodeId n) {
    for (; n != kNone; n = structure_.nodes[n].parent) refresh_node(structure_, n);
}

}  // namespace crofton::boxtree
