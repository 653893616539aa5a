// SPDX-License-Identifier: MIT
// Does a tree keep all its promises?
#include <algorithm>
#include <cmath>
#include <crofton/boxtree/box_tree.hpp>
#include <string>

#include "bounds.hpp"

namespace crofton::boxtree {
namespace {

tl::unexpected<Error> broken(std::uint64_t item, const char* what) {
    return fail(ErrorCode::internal, item, std::string("box tree: ") + what);
}

bool lanes_agree(const Leaf& a, const Leaf& b, unsigned lane) {
    bool same = a.layers[lane] == b.layers[lane] && a.xy[lane] == b.xy[lane] &&
                a.z_edge2_z[lane] == b.z_edge2_z[lane] && a.edge01_z[lane] == b.edge01_z[lane];
    for (int k = 0; k < 3; ++k) same = same && a.edge_xy[k][lane] == b.edge_xy[k][lane];
    return same;
}

std::uint32_t items_without_gaps(LeafRange range, std::span<const std::uint8_t> leaf_counts) {
    if (range.count == 0) return 0;
    const LeafId last = range.first + range.count - 1;
    for (LeafId l = range.first; l < last; ++l)
        if (leaf_counts[l] < kWidth) return 0;
    return (range.count - 1) * kWidth + leaf_counts[last];
}

bool holds(const Node& node, unsigned lane, const Aabb& child) {
    if (child.is_empty()) return true;
    const Aabb bounds = bounds_of_lane(node, lane);
    double reach = 0.0;
    for (unsigned axis = 0; axis < 3; ++axis) {
        const int j = static_cast<int>(axis), far = std::abs(middle_of(node, lane, axis)) + half_of(node, lane, axis);
        if (!(bounds.min[j] <= child.min[j] && bounds.max[j] >= child.max[j])) return false;
        if (far > 32767) return false;
        reach += double{node.unit} * far;
    }
    return reach <= double{node.reach};
}

}  // namespace

Result<void> BoxTree::validate() const {
    return validate(Trust::nothing);
}

Result<void> BoxTree::validate(Trust trust) const {
    const std::size_t nodes = structure_.nodes.size(), leaves = structure_.leaves.size();
    if (nodes == 0 || structure_.ranges.size() != nodes || structure_.leaf_counts.size() != leaves ||
        structure_.slot_items.size() != leaves * kWidth || structure_.item_slots.size() != boxes_.size() ||
        layer_masks_.size() != boxes_.size())
        return broken(kNoItem, "array sizes do not match");
    for (LeafId l = 0; l < leaves; ++l)
        if (structure_.leaves[l].count > kWidth) return broken(l, "a leaf has more than 16 items");
    for (NodeId n = 0; n < nodes; ++n)
        if (structure_.nodes[n].count > kWidth) return broken(n, "a node has more than 16 children");
    std::size_t reached = 1;
    for (NodeId n = 0; n < nodes; ++n) {
        const Node& node = structure_.nodes[n];
        bool only_leaves = true;
        for (unsigned lane = 0; lane < node.count; ++lane, ++reached) {
            const std::uint32_t child = node.child[lane], id = child & ~kLeafBit;
            const bool is_leaf = (child & kLeafBit) != 0;
            if (id >= (is_leaf ? leaves : nodes)) return broken(n, "a node's child does not exist");
            only_leaves = only_leaves && is_leaf;
            const NodeId parent = is_leaf ? structure_.leaves[id].parent : structure_.nodes[id].parent;
            const std::uint32_t at =
                is_leaf ? structure_.leaves[id].lane_in_parent : structure_.nodes[id].lane_in_parent;
            if (parent != n || at != lane || child == 0) return broken(n, "a child does not know its parent");
            if (trust == Trust::contents) continue;
            if (!holds(node, lane, is_leaf ? bounds_of(structure_.leaves[id]) : bounds_of(structure_.nodes[id])))
                return broken(n, "a bound does not contain what lies below it");
            Node layers;
            if (is_leaf)
                write_layers(layers, lane, structure_.leaves[id].layers, structure_.leaves[id].layers,
                             structure_.leaves[id].count);
            else
                write_layers(layers, lane, structure_.nodes[id].layers_any, structure_.nodes[id].layers_all,
                             structure_.nodes[id].count);
            if (layers.layers_any[lane] != node.layers_any[lane] || layers.layers_all[lane] != node.layers_all[lane])
                return broken(n, "layers do not match those below");
        }
        if (trust == Trust::nothing) {
            std::uint32_t every = ~std::uint32_t{0};
            for (unsigned lane = 0; lane < node.count; ++lane) every &= node.layers_all[lane];
            if (!is_frame(node) || every != node.layers_every) return broken(n, "a node's frame is not one");
        }
        if (only_leaves != (node.only_leaves != 0)) return broken(n, "a node is wrong about its children's kind");
        if (const LeafRange range = structure_.ranges[n]; range.count > leaves || range.first > leaves - range.count)
            return broken(n, "a node's leaves do not exist");
        if (const LeafRange range = structure_.ranges[n];
            range.items != 0 && range.items != boxtree::items_without_gaps(range, leaf_counts()))
            return broken(n, "a node is wrong about its items");
        // Up to the root within `height` steps: no cycles.
        NodeId up = n;
        unsigned steps = 1;
        for (; structure_.nodes[up].parent != kNone; up = structure_.nodes[up].parent)
            if (++steps > structure_.height || structure_.nodes[up].parent >= nodes)
                return broken(n, "a node is too deep, or in a cycle");
        if (up != 0) return broken(n, "a node is not below the root");
    }
    if (reached != nodes + leaves) return broken(kNoItem, "a node or leaf is below no node");
    return validate_leaves(trust);
}

Result<void> BoxTree::validate_leaves(Trust trust) const {
    std::size_t items = 0;
    for (LeafId l = 0; l < structure_.leaves.size(); ++l) {
        const Leaf& leaf = structure_.leaves[l];
        if (leaf.count != structure_.leaf_counts[l]) return broken(l, "a leaf's count is wrong");
        items += leaf.count;
        for (unsigned lane = 0; lane < kWidth; ++lane) {
            const ItemId item = structure_.slot_items[l * kWidth + lane];
            if ((item != kNone) != (lane < leaf.count)) return broken(l, "a leaf's lanes do not match its count");
            if (item == kNone) {
                if (leaf.layers[lane] != 0) return broken(l, "an empty lane has layers");
                continue;
            }
            if (item >= boxes_.size() || structure_.item_slots[item] != l * kWidth + lane)
                return broken(item, "an item is not where its slot says");
            if (trust == Trust::contents) continue;
            if (auto valid = crofton::validate(boxes_[item], item); !valid) return valid;
            Leaf expected = leaf;
            expected.layers[lane] = layer_masks_[item];
            if (!is_frame(leaf) || !write_lane(expected, lane, boxes_[item]) || !lanes_agree(leaf, expected, lane) ||
                expected.reach > leaf.reach || (leaf.layers_every & ~layer_masks_[item]) != 0)
                return broken(item, "an item's lane does not match its box");
        }
    }
    for (const ItemId item : free_items_)
        if (item >= boxes_.size() || structure_.item_slots[item] != kNone) return broken(item, "a free id is in use");
    if (items != item_count()) return broken(kNoItem, "the leaves do not hold all items");
    return {};
}

}  // namespace crofton::boxtree
