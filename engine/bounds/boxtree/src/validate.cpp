// SPDX-License-Identifier: MIT
// Checks every invariant of a tree.
#include <algorithm>
#include <cmath>
#include <crofton/boxtree/structure.hpp>
#include <string>

#include <crofton/boxtree/radius_range.hpp>
#include "bounds.hpp"
#include "turned_bounds.hpp"

namespace crofton::boxtree {
namespace {

Error broken(std::uint64_t item, const char* what) {
    return fail(ErrorCode::internal, item, {"box tree: ", what});
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

// Whether the leaves below the children follow each other, as the node's range says.
bool keeps_range(const Structure& structure, NodeId n) {
    const Node& node = structure.nodes()[n];
    const LeafRange range = structure.leaf_ranges()[n];
    if (range.count == 0) return true;
    std::uint64_t next = range.first;
    for (std::uint32_t lane = 0; lane < node.count; ++lane) {
        const std::uint32_t child = node.child[lane], id = child & ~kLeafBit;
        const LeafRange below = child & kLeafBit ? LeafRange{id, 1} : structure.leaf_ranges()[id];
        if (below.count == 0 || below.first != next) return false;
        next += below.count;
    }
    return next == std::uint64_t{range.first} + range.count;
}

bool holds(const Node& node, const Axes& axes, unsigned lane, const Aabb& child) {
    if (child.is_empty()) return true;
    const Aabb bounds = bounds_of_lane(node, lane, axes);
    double l1_radius = 0.0;
    for (unsigned axis = 0; axis < 3; ++axis) {
        const int j = static_cast<int>(axis), far = std::abs(middle_of(node, lane, axis)) + half_of(node, lane, axis);
        if (!(bounds.min[j] <= child.min[j] && bounds.max[j] >= child.max[j])) return false;
        if (far > 32767) return false;
        l1_radius += double{node.unit} * far;
    }
    return l1_radius <= double{node.l1_radius};
}

// Whether the links upwards lead to the root, and not in a circle or on a path longer than the tree is high.
bool reaches_root(const Structure& structure, NodeId n, bool& too_deep) {
    const std::span<const Node> nodes = structure.nodes();
    unsigned steps = 1;
    too_deep = false;
    for (; nodes[n].parent != kNone; n = nodes[n].parent)
        if (++steps > structure.height() || nodes[n].parent >= nodes.size()) {
            too_deep = true;
            return false;
        }
    return n == 0;
}

Result<void> validate_axes(const Structure& structure) {
    const std::span<const Axes> axes = structure.axes();
    if (axes.empty() || !are_the_worlds(axes[0])) return broken(kNoItem, "the first axes are not the world's");
    for (std::size_t i = 0; i < axes.size(); ++i)
        if (!are_valid(axes[i])) return broken(i, "axes are not orthonormal");
    for (NodeId n = 0; n < structure.nodes().size(); ++n)
        if (structure.nodes()[n].axes >= axes.size()) return broken(n, "a node's axes do not exist");
    return {};
}

Result<void> validate_child(const Structure& structure, NodeId n, unsigned lane, Trust trust) {
    const std::span<const Node> nodes = structure.nodes();
    const std::span<const Leaf> leaves = structure.leaves();
    const std::uint32_t child = nodes[n].child[lane], id = child & ~kLeafBit;
    const bool is_leaf = (child & kLeafBit) != 0;
    if (id >= (is_leaf ? leaves.size() : nodes.size())) return broken(n, "a node's child does not exist");
    const NodeId parent = is_leaf ? leaves[id].parent : nodes[id].parent;
    const std::uint32_t at = is_leaf ? leaves[id].lane_in_parent : nodes[id].lane_in_parent;
    if (parent != n || at != lane || child == 0) return broken(n, "a child does not know its parent");
    if (trust == Trust::contents) return {};
    if (!holds(nodes[n], structure.axes_of(nodes[n]), lane, structure.bounds_below(child, nodes[n].axes)))
        return broken(n, "a bound does not contain the boxes below it");
    Node layers;
    if (is_leaf)
        write_layers(layers, lane, leaves[id].layers, leaves[id].layers, leaves[id].count);
    else
        write_layers(layers, lane, nodes[id].layers_any, nodes[id].layers_all, nodes[id].count);
    if (layers.layers_any[lane] != nodes[n].layers_any[lane] || layers.layers_all[lane] != nodes[n].layers_all[lane])
        return broken(n, "layers do not match those below");
    RadiusRange radii = is_leaf ? structure.leaf_radii()[id] : kNoRadii;
    for (unsigned i = 0; !is_leaf && i < nodes[id].count; ++i)
        radii = united(radii, structure.node_radii()[id].below[i]);
    if (!includes(structure.node_radii()[n].below[lane], radii))
        return broken(n, "a range of radii does not contain those below");
    return {};
}

Result<void> validate_node(const Structure& structure, NodeId n, Trust trust) {
    const Node& node = structure.nodes()[n];
    bool only_leaves = true;
    for (unsigned lane = 0; lane < node.count; ++lane) {
        if (auto valid = validate_child(structure, n, lane, trust); !valid) return valid;
        only_leaves = only_leaves && (node.child[lane] & kLeafBit) != 0;
    }
    if (trust == Trust::nothing) {
        std::uint32_t every = ~std::uint32_t{0};
        for (unsigned lane = 0; lane < node.count; ++lane) every &= node.layers_all[lane];
        if (!is_frame(node) || every != node.layers_every) return broken(n, "a node's frame is not one");
    }
    if (only_leaves != (node.only_leaves != 0)) return broken(n, "a node is wrong about its children's kind");
    const LeafRange range = structure.leaf_ranges()[n];
    if (range.count > structure.leaves().size() || range.first > structure.leaves().size() - range.count)
        return broken(n, "a node's leaves do not exist");
    if (!keeps_range(structure, n)) return broken(n, "a node promises other leaves than it has below");
    if (range.items != 0 && range.items != items_without_gaps(range, structure.leaf_counts()))
        return broken(n, "a node is wrong about its items");
    bool too_deep = false;
    if (!reaches_root(structure, n, too_deep))
        return broken(n, too_deep ? "a node is too deep, or in a cycle" : "a node is not below the root");
    // Then there are no more nodes than leaves below any node, which queries rely on.
    if (n != 0 && node.count < 2) return broken(n, "a node has fewer than two children");
    return {};
}

Result<void> validate_item(const Structure& structure, std::uint32_t slot, Trust trust) {
    const Items& items = structure.items();
    const ItemId item = structure.slot_items()[slot];
    const Leaf& leaf = structure.leaves()[slot / kWidth];
    const unsigned lane = slot % kWidth;
    if (item >= items.size() || structure.slot_of(item) != slot)
        return broken(item, "an item is not where its slot says");
    if (trust == Trust::contents) return {};
    const Obb& box = items.boxes()[item];
    const std::uint32_t layers = items.layer_masks()[item];
    if (auto valid = crofton::validate(box, item); !valid) return valid;
    Leaf expected = leaf;
    expected.layers[lane] = layers;
    if (!is_frame(leaf) || !write_lane(expected, lane, box) || !lanes_agree(leaf, expected, lane) ||
        expected.l1_radius > leaf.l1_radius || (leaf.layers_every & ~layers) != 0)
        return broken(item, "an item's lane does not match its box");
    if (!includes(structure.leaf_radii()[slot / kWidth], radius_range_of(box)))
        return broken(item, "the leaf's range of radii does not contain the item's");
    return {};
}

Result<void> validate_leaf(const Structure& structure, LeafId l, Trust trust) {
    const Leaf& leaf = structure.leaves()[l];
    if (leaf.count != structure.leaf_counts()[l]) return broken(l, "a leaf's count is wrong");
    for (unsigned lane = 0; lane < kWidth; ++lane) {
        const std::uint32_t slot = l * kWidth + lane;
        if ((structure.slot_items()[slot] != kNone) != (lane < leaf.count))
            return broken(l, "a leaf's lanes do not match its count");
        if (lane >= leaf.count) {
            if (leaf.layers[lane] != 0) return broken(l, "an empty lane has layers");
            continue;
        }
        if (auto valid = validate_item(structure, slot, trust); !valid) return valid;
    }
    return {};
}

}  // namespace

Result<void> validate(const Structure& structure, Trust trust, detail::StopSignal* stop) {
    const Items& items = structure.items();
    const std::span<const Node> nodes = structure.nodes();
    const std::span<const Leaf> leaves = structure.leaves();
    if (nodes.empty() || structure.leaf_ranges().size() != nodes.size() ||
        structure.leaf_counts().size() != leaves.size() || structure.leaf_radii().size() != leaves.size() ||
        structure.node_radii().size() != nodes.size() || structure.slot_items().size() != leaves.size() * kWidth ||
        structure.item_slots().size() != items.size() || items.layer_masks().size() != items.size())
        return broken(kNoItem, "array sizes do not match");
    for (LeafId l = 0; l < leaves.size(); ++l)
        if (leaves[l].count > kWidth) return broken(l, "a leaf has more than 16 items");
    for (NodeId n = 0; n < nodes.size(); ++n)
        if (nodes[n].count > kWidth) return broken(n, "a node has more than 16 children");
    if (auto valid = validate_axes(structure); !valid) return valid;
    std::size_t reached = 1, in_leaves = 0;
    const auto wants_stop = [&](std::size_t done) {
        constexpr std::size_t kBetweenQuestions = 256;
        return stop != nullptr && done % kBetweenQuestions == 0 &&
               stop->is_raised(static_cast<double>(done) / static_cast<double>(nodes.size() + leaves.size()));
    };
    for (NodeId n = 0; n < nodes.size(); ++n) {
        if (wants_stop(n)) return detail::cancelled("box tree");
        if (auto valid = validate_node(structure, n, trust); !valid) return valid;
        reached += nodes[n].count;
    }
    if (reached != nodes.size() + leaves.size()) return broken(kNoItem, "a node or leaf is below no node");
    for (LeafId l = 0; l < leaves.size(); ++l) {
        if (wants_stop(nodes.size() + l)) return detail::cancelled("box tree");
        if (auto valid = validate_leaf(structure, l, trust); !valid) return valid;
        in_leaves += leaves[l].count;
    }
    for (const ItemId item : items.free_ids())
        if (item >= items.size() || structure.contains(item)) return broken(item, "a free id is in use");
    if (in_leaves != items.count_in_leaves()) return broken(kNoItem, "the leaves do not hold all items");
    return {};
}

}  // namespace crofton::boxtree
