// SPDX-License-Identifier: MIT
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/valid_boxes.hpp>

#include <hwy/cache_control.h>
#include <algorithm>
#include <crofton/core/diagnostics.hpp>
#include <crofton/core/recovery.hpp>

#include "bounds.hpp"
#include "leaf_writer.hpp"
#include "rebuild.hpp"

namespace crofton::boxtree {
namespace {

constexpr std::size_t kMaxItems = std::size_t{1} << 30;
constexpr std::size_t kGrain = 1024;
constexpr std::size_t kSubtreeBatch = 32;

}  // namespace

BoxTree::BoxTree() = default;
BoxTree::~BoxTree() = default;
BoxTree::BoxTree(BoxTree&&) noexcept = default;
BoxTree& BoxTree::operator=(BoxTree&&) noexcept = default;

Result<BoxTree> BoxTree::build(std::span<const Obb> boxes, const BuildOptions& options, Executor& executor) {
    return build(boxes, {}, options, executor);
}

Result<BoxTree> BoxTree::build(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks,
                               const BuildOptions& options, Executor& executor) {
    return detail::recover([&]() -> Result<BoxTree> {
        if (boxes.size() > kMaxItems) return fail(ErrorCode::out_of_range, kMaxItems, "box tree: more than 2^30 boxes");
        if (!layer_masks.empty() && layer_masks.size() != boxes.size())
            return fail(ErrorCode::invalid_argument, kNoItem,
                        "box tree: as many layer masks as boxes are needed, or none");
        if (auto valid = measure::validate(options.criterion); !valid) return tl::unexpected(valid.error());
        Vector<std::uint64_t> moving((boxes.size() + 63) / 64, 0);
        for (const ItemId item : options.moving) {
            if (item >= boxes.size())
                return fail(ErrorCode::out_of_range, item, "box tree: no box for an item that moves");
            moving[item / 64] |= std::uint64_t{1} << item % 64;
        }
        const auto moves = [](const void* bits, ItemId item) {
            return (static_cast<const std::uint64_t*>(bits)[item / 64] >> item % 64 & 1) != 0;
        };
        BoxTree tree;
        tree.criterion_ = options.criterion;
        Aabb scene;
        if (auto taken = tree.copy_and_validate(boxes, scene); !taken) return tl::unexpected(taken.error());
        tree.layer_masks_.assign(layer_masks.begin(), layer_masks.end());
        tree.layer_masks_.resize(boxes.size(), ~std::uint32_t{0});
        for (const ItemId item : options.detached) {
            if (item >= boxes.size())
                return fail(ErrorCode::out_of_range, item, "box tree: no box for an item to detach");
            if (!tree.is_detached(item)) tree.set_detached(item, true);
        }
        Builder builder(scene, tree.item_count(), options.criterion);
        for (ItemId item = 0; item < boxes.size(); ++item)
            if (!tree.is_detached(item)) builder.add(item, tree.boxes_[item]);
        while (!builder.prepare(~std::size_t{0} / 8, tree.boxes_, {moves, moving.data()})) {
        }
        tree.build_subtrees(builder, executor);
        return tree;
    });
}

// Checks the boxes and copies them while they are at hand.
Result<void> BoxTree::copy_and_validate(std::span<const Obb> boxes, Aabb& scene) {
    boxes_.reserve(boxes.size());
    for (std::size_t begin = 0; begin < boxes.size(); begin += kGrain) {
        const std::span<const Obb> some = boxes.subspan(begin, std::min(kGrain, boxes.size() - begin));
        for (std::size_t i = count_certainly_valid(some.data(), some.size()); i < some.size(); ++i)
            if (auto valid = crofton::validate(some[i], begin + i); !valid) return valid;
        for (const Obb& box : some) scene.include(box.center);
        boxes_.insert(boxes_.end(), some.begin(), some.end());
    }
    return {};
}

// Each subtree's leaves and nodes right after it is divided: its boxes are in the cache then.
void BoxTree::build_subtrees(Builder& builder, Executor& executor) {
    const Topology& topology = builder.result();
    const std::span<const Subtree> subtrees = builder.subtrees();
    start(structure_, topology);
    structure_.leaves.reserve(topology.leaves.size());
    Vector<SubtreeBuilder> workers(executor.concurrency());
    // A batch's leaves are written before they have left the cache where they were made.
    for (std::size_t first = 0; first < subtrees.size(); first += kSubtreeBatch) {
        const std::size_t count = std::min(kSubtreeBatch, subtrees.size() - first);
        const Subtree& last = subtrees[first + count - 1];
        structure_.leaves.resize(last.first_leaf + last.leaves);
        detail::recoverable_for(executor, count, 1, [&](std::size_t begin, std::size_t end, unsigned worker) {
            for (std::size_t s = first + begin; s < first + end; ++s) {
                builder.build(s, workers[worker], boxes_);
                const Subtree& subtree = subtrees[s];
                const LeafId leaves_end = subtree.first_leaf + subtree.leaves;
                for (LeafId l = subtree.first_leaf; l < leaves_end; ++l) fill_leaf(structure_, l, leaves_end, topology);
                finish_nodes(subtree.first_node, subtree.first_node + subtree.nodes, topology);
            }
        });
    }
    finish_nodes(0, subtrees.front().first_node, topology);
}

void BoxTree::finish_nodes(NodeId begin, NodeId end, const Topology& topology) {
    for (NodeId n = begin; n < end; ++n) init_node(structure_, n, topology);
    // Parents come before children.
    for (NodeId n = end; n-- > begin;) finish_node(structure_, n);
}

// Room for a new structure.
void BoxTree::start(Structure& structure, const Topology& topology) const {
    structure.height = topology.height;
    structure.nodes.resize(topology.nodes.size());
    structure.ranges.resize(topology.nodes.size());
    structure.leaf_counts.assign(topology.leaves.size(), 0);
    structure.slot_items.assign(topology.leaves.size() * kWidth, kNone);
    structure.item_slots.assign(boxes_.size(), kNone);
    structure.dirty_lanes.assign(topology.leaves.size(), 0);
    structure.moved_last_refit.assign(topology.leaves.size(), 0);
    structure.moved_two_refits_ago.assign(topology.leaves.size(), 0);
}

void BoxTree::init_node(Structure& structure, NodeId n, const Topology& topology) const {
    const Topology::NodeRecord& record = topology.nodes[n];
    Node& node = structure.nodes[n];
    clear(node);
    structure.ranges[n] = record.leaves;
    node.count = record.count;
    node.parent = record.parent;
    node.lane_in_parent = record.lane_in_parent;
    node.only_leaves = 1;
    for (std::uint32_t lane = 0; lane < record.count; ++lane) {
        node.child[lane] = record.child[lane];
        if (!(record.child[lane] & kLeafBit)) node.only_leaves = 0;
    }
}

void BoxTree::clear_marks(Structure& structure) {
    structure.dirty_lanes.assign(structure.leaves.size(), 0);
    structure.moved_last_refit.assign(structure.leaves.size(), 0);
    structure.moved_two_refits_ago.assign(structure.leaves.size(), 0);
}

// Leaves before `end` may be looked at already: others may still be in the making, on other threads.
void BoxTree::fill_leaf(Structure& structure, LeafId l, LeafId end, const Topology& topology) const {
    const Topology::LeafRecord& record = topology.leaves[l];
    // The boxes lie in the order of their ids: ask early for those of the leaf after the next.
    if (l + 2 < end) {
        const Topology::LeafRecord& ahead = topology.leaves[l + 2];
        for (std::uint32_t i = 0; i < ahead.count; ++i) {
            prefetch_item(topology.order[ahead.first + i]);
            hwy::Prefetch(&layer_masks_[topology.order[ahead.first + i]]);
            hwy::Prefetch(&structure.item_slots[topology.order[ahead.first + i]]);
        }
    }
    Leaf& leaf = structure.leaves[l];
    clear(leaf);
    leaf.parent = record.parent;
    leaf.lane_in_parent = record.lane_in_parent;
    for (std::uint32_t i = 0; i < record.count; ++i) {
        const ItemId item = topology.order[record.first + i];
        if (&structure != &structure_ && structure_.item_slots[item] == kNone)
            continue;  // removed since this was begun
        const std::uint32_t slot = l * kWidth + leaf.count++;
        structure.slot_items[slot] = item;
        structure.item_slots[item] = slot;
    }
    structure.leaf_counts[l] = static_cast<std::uint8_t>(leaf.count);
    write_leaf_layers(structure, l);
    rewrite_leaf(structure, l);
}

void BoxTree::write_leaf_layers(Structure& structure, LeafId l) const {
    Leaf& leaf = structure.leaves[l];
    leaf.layers_every = ~std::uint32_t{0};
    for (std::uint32_t lane = 0; lane < leaf.count; ++lane) {
        leaf.layers[lane] = layer_masks_[structure.slot_items[l * kWidth + lane]];
        leaf.layers_every &= leaf.layers[lane];
    }
}

void BoxTree::prefetch_item(ItemId item) const {
    hwy::Prefetch(&boxes_[item]);
    hwy::Prefetch(&boxes_[item].half_extents);
}

// Writes all boxes anew in a fitting frame.
void BoxTree::rewrite_leaf(Structure& structure, LeafId l) const {
    Leaf& leaf = structure.leaves[l];
    Aabb centers;
    double longest = 0.0;
    for (std::uint32_t lane = 0; lane < leaf.count; ++lane) {
        const Obb& box = boxes_[structure.slot_items[l * kWidth + lane]];
        centers.include(box.center);
        longest = std::max(longest, longest_edge(box));
    }
    fit_frame(leaf, centers, longest);
    [[maybe_unused]] const std::size_t written =
        write_lanes(structure.leaves.data(), std::span(&l, 1), structure.slot_items.data(), boxes_.data());
    CROFTON_ASSERT(written == 1, "a frame around boxes must take them");
}

// An item's box and layers into its slot, all boxes anew if the leaf's frame does not take it.
void BoxTree::write_item(Structure& structure, ItemId item) const {
    const std::uint32_t slot = structure.item_slots[item];
    write_layers(structure.leaves[slot / kWidth], slot % kWidth, layer_masks_[item]);
    if (!write_lane(structure.leaves[slot / kWidth], slot % kWidth, boxes_[item]))
        rewrite_leaf(structure, slot / kWidth);
}

// Boxes that have changed into the lanes of leaves where move() has not written them: where they are many.
void BoxTree::write_dirty_leaves(Structure& structure, std::span<const LeafId> leaves) const {
    LeafId many[kRefitBatch];
    std::size_t many_count = 0;
    CROFTON_ASSERT(leaves.size() <= kRefitBatch, "too many leaves at once");
    for (const LeafId l : leaves)
        if (!at_most_three_bits(structure.dirty_lanes[l])) many[many_count++] = l;
    for (std::span<const LeafId> rest(many, many_count); !rest.empty(); rest = rest.subspan(1)) {
        rest = rest.subspan(write_lanes(structure.leaves.data(), rest, structure.slot_items.data(), boxes_.data()));
        if (rest.empty()) break;
        rewrite_leaf(structure, rest.front());
    }
}

// Bounds, layers and the number of items, from the children's.
void BoxTree::finish_node(Structure& structure, NodeId n) const {
    refresh_node(structure, n);
    structure.ranges[n].items = items_without_gaps(structure, n);
}

// 0 where a slot is empty that is not among the last.
std::uint32_t BoxTree::items_without_gaps(const Structure& structure, NodeId n) {
    const Node& node = structure.nodes[n];
    if (structure.ranges[n].count == 0) return 0;
    std::uint32_t items = 0;
    for (std::uint32_t lane = 0; lane < node.count; ++lane) {
        const std::uint32_t child = node.child[lane], id = child & ~kLeafBit;
        const LeafRange below =
            child & kLeafBit ? LeafRange{id, 1, structure.leaf_counts[id]} : structure.ranges[child];
        const bool has_gap = below.items == 0 || (lane + 1 < node.count && below.items < below.count * kWidth);
        if (has_gap) return 0;
        items += below.items;
    }
    return items;
}

// The items of a leaf below here are no longer as many as they were.
void BoxTree::invalidate_item_count(NodeId n) {
    for (; n != kNone && structure_.ranges[n].items != 0; n = structure_.nodes[n].parent)
        structure_.ranges[n].items = 0;
}

// Bounds and layers of all lanes from the children, in a fitting frame.
void BoxTree::refresh_node(Structure& structure, NodeId n) const {
    Node& node = structure.nodes[n];
    Aabb bounds[kWidth], whole;
    for (std::uint32_t lane = 0; lane < node.count; ++lane) {
        const std::uint32_t child = node.child[lane];
        bounds[lane] =
            child & kLeafBit ? bounds_of(structure.leaves[child & ~kLeafBit]) : bounds_of(structure.nodes[child]);
        if (!bounds[lane].is_empty()) whole.include(bounds[lane]);
    }
    fit_frame(node, whole);
    for (std::uint32_t lane = 0; lane < node.count; ++lane) {
        [[maybe_unused]] const bool fits = write_lane(node, lane, bounds[lane]);
        CROFTON_ASSERT(fits, "a frame around bounds must take them");
        refresh_layers(structure, n, lane);
    }
}

void BoxTree::refresh_layers(Structure& structure, NodeId n, unsigned lane) const {
    Node& node = structure.nodes[n];
    const std::uint32_t child = node.child[lane];
    if (child & kLeafBit) {
        const Leaf& leaf = structure.leaves[child & ~kLeafBit];
        write_layers(node, lane, leaf.layers, leaf.layers, leaf.count);
    } else {
        const Node& below = structure.nodes[child];
        write_layers(node, lane, below.layers_any, below.layers_all, below.count);
    }
    node.layers_every = ~std::uint32_t{0};
    for (unsigned i = 0; i < node.count; ++i) node.layers_every &= node.layers_all[i];
}

Aabb BoxTree::child_bounds(NodeId node, unsigned lane) const {
    CROFTON_ASSERT(node < nodes().size() && lane < nodes()[node].count, "no such child");
    return bounds_of_lane(nodes()[node], lane);
}

Result<void> BoxTree::check_item(ItemId item) const {
    if (is_detached(item))
        return fail(ErrorCode::out_of_range, item, "box tree: the item has been detached; attach it first");
    if (!is_present(item)) return fail(ErrorCode::out_of_range, item, "box tree: no such item, or it has been removed");
    return {};
}

}  // namespace crofton::boxtree
