// SPDX-License-Identifier: MIT
// Leaves from items, nodes from what is below them.
#include <crofton/boxtree/structure.hpp>

#include <hwy/cache_control.h>
#include <algorithm>
#include <atomic>
#include <crofton/core/error.hpp>
#include <limits>

#include <crofton/boxtree/radius_range.hpp>
#include "bounds.hpp"
#include "leaf_writer.hpp"
#include "subtree.hpp"
#include "turned_bounds.hpp"

namespace crofton::boxtree {
namespace {

std::uint64_t next_number() {
    static std::atomic<std::uint64_t> last{0};
    return ++last;
}

}  // namespace

Structure::Structure(Items& items, const measure::Criterion& criterion, Orientation orientation)
    : items_(items), criterion_(criterion), orientation_(orientation), slots_version_{.structure = next_number()} {}

Aabb Structure::child_bounds(NodeId node, unsigned lane) const {
    CROFTON_ASSERT(node < nodes_.size() && lane < nodes_[node].count, "no such child");
    const Axes& axes = axes_of(nodes_[node]);
    const Aabb bounds = bounds_of_lane(nodes_[node], lane, axes);
    return nodes_[node].axes == 0 ? bounds : bounds_along(axes_[0], bounds, axes);
}

// Along other axes than the node's own, computed from the leaves: boxes around turned boxes would be larger.
Aabb Structure::bounds_below(std::uint32_t child, std::uint32_t axes) const {
    if (child & kLeafBit) return bounds_along(axes_[axes], leaves_[child & ~kLeafBit]);
    const Node& node = nodes_[child];
    if (node.axes == axes) return bounds_of(node, axes_[axes]);
    Aabb bounds;
    for (std::uint32_t lane = 0; lane < node.count; ++lane)
        if (const Aabb below = bounds_below(node.child[lane], axes); !below.is_empty()) bounds.include(below);
    return bounds;
}

void Structure::make_room(const Topology& topology, std::size_t more_items) {
    // An insertion into a full leaf splits it: of the first ones most, later few.
    const std::size_t leaves = std::min(more_items, more_items / 8 + kWidth);
    reserve(topology.nodes.size() + leaves / 2, topology.leaves.size() + leaves);
    item_slots_.reserve(items_.size() + more_items);
    height_ = topology.height;
    axes_.resize(std::max(axes_.size(), topology.axes.size()));
    nodes_.resize(topology.nodes.size());
    ranges_.resize(topology.nodes.size());
    node_radii_.resize(topology.nodes.size());
    leaf_counts_.assign(topology.leaves.size(), 0);
    leaf_radii_.assign(topology.leaves.size(), kNoRadii);
    slot_items_.assign(topology.leaves.size() * kWidth, kNone);
    item_slots_.assign(items_.size(), kNone);
    marks_.reset(topology.leaves.size());
}

void Structure::reserve(std::size_t nodes, std::size_t leaves) {
    nodes_.reserve(nodes);
    ranges_.reserve(nodes);
    node_radii_.reserve(nodes);
    leaves_.reserve(leaves);
    leaf_counts_.reserve(leaves);
    leaf_radii_.reserve(leaves);
    slot_items_.reserve(leaves * kWidth);
    marks_.reserve(leaves);
}

// Makes room for the leaves before `end`, just before they are written, so that the new memory is in the cache.
void Structure::make_room_for_leaves(LeafId end) {
    leaves_.resize(end);
}

void Structure::link_nodes(NodeId begin, NodeId end, const Topology& topology) {
    for (NodeId n = begin; n < end; ++n) init_node(n, topology);
}

void Structure::init_node(NodeId n, const Topology& topology) {
    const Topology::NodeRecord& record = topology.nodes[n];
    Node& node = nodes_.edit(n);
    clear(node);
    ranges_[n] = record.leaves;
    node.count = record.count;
    node.parent = record.parent;
    node.lane_in_parent = record.lane_in_parent;
    node.axes = record.axes;
    if (record.axes == n + 1) axes_[n + 1] = topology.axes[n + 1];
    node.only_leaves = 1;
    for (std::uint32_t lane = 0; lane < record.count; ++lane) {
        node.child[lane] = record.child[lane];
        if (!(record.child[lane] & kLeafBit)) node.only_leaves = 0;
    }
}

void Structure::fill_leaf(LeafId l, LeafId end, const Topology& topology, const Structure* current) {
    const Topology::LeafRecord& record = topology.leaves[l];
    // The boxes lie in the order of their ids: ask early for those of the leaf after the next.
    if (l + 2 < end) {
        const Topology::LeafRecord& ahead = topology.leaves[l + 2];
        for (std::uint32_t i = 0; i < ahead.count; ++i) {
            const ItemId item = topology.order[ahead.first + i];
            hwy::Prefetch(&items_.boxes()[item]);
            hwy::Prefetch(&items_.boxes()[item].half_extents);
            hwy::Prefetch(&items_.layer_masks()[item]);
            hwy::Prefetch(&item_slots_[item]);
        }
    }
    Leaf& leaf = leaves_.edit(l);
    clear(leaf);
    leaf.parent = record.parent;
    leaf.lane_in_parent = record.lane_in_parent;
    for (std::uint32_t i = 0; i < record.count; ++i) {
        const ItemId item = topology.order[record.first + i];
        if (current != nullptr && !current->contains(item)) continue;
        const std::uint32_t slot = l * kWidth + leaf.count++;
        slot_items_.set(slot, item);
        item_slots_.set(item, slot);
    }
    leaf_counts_[l] = static_cast<std::uint8_t>(leaf.count);
    write_leaf_layers(l);
    write_leaf_radii(l);
    rewrite_leaf(l);
}

// Computes bounds, layers, radii and counts of items from the children's. Goes backwards: parents are stored first.
void Structure::bound_nodes(NodeId begin, NodeId end) {
    for (NodeId n = end; n-- > begin;) {
        refresh_node(n);
        ranges_[n].items = items_without_gaps(n);
    }
}

void Structure::begin_steps(const Topology& topology) {
    height_ = topology.height;
    axes_.resize(std::max(axes_.size(), topology.axes.size()));
    // With room for what changes will add: where items change so much that the tree is rebuilt, it will grow.
    reserve(with_room(topology.nodes.size()), with_room(topology.leaves.size()));
    item_slots_.reserve(std::max(with_room(items_.size()), items_.capacity()));
}

void Structure::add_items(ItemId end) {
    if (end > item_slots_.size()) item_slots_.append(end - item_slots_.size(), kNone);
}

void Structure::add_nodes(NodeId end, const Topology& topology) {
    const auto begin = static_cast<NodeId>(nodes_.size());
    nodes_.resize(end);
    ranges_.resize(end);
    node_radii_.resize(end);
    link_nodes(begin, end, topology);
}

void Structure::add_leaves(LeafId end, const Topology& topology, const Structure& current) {
    const auto begin = static_cast<LeafId>(leaves_.size()), all = static_cast<LeafId>(topology.leaves.size());
    leaves_.resize(end);
    leaf_counts_.resize(end, 0);
    leaf_radii_.resize(end, kNoRadii);
    slot_items_.resize(std::size_t{end} * kWidth, kNone);
    for (LeafId l = begin; l < end; ++l) fill_leaf(l, all, topology, &current);
}

void Structure::write_leaf_layers(LeafId l) {
    Leaf& leaf = leaves_.edit(l);
    leaf.layers_every = ~std::uint32_t{0};
    for (std::uint32_t lane = 0; lane < leaf.count; ++lane) {
        leaf.layers[lane] = items_.layer_masks()[slot_items_[l * kWidth + lane]];
        leaf.layers_every &= leaf.layers[lane];
    }
}

void Structure::write_leaf_radii(LeafId l) {
    double least = std::numeric_limits<double>::infinity(), most = 0.0;
    for (std::uint32_t lane = 0; lane < leaves_[l].count; ++lane) {
        const double square = square_of_radius(items_.boxes()[slot_items_[l * kWidth + lane]]);
        least = std::min(least, square);
        most = std::max(most, square);
    }
    leaf_radii_[l] = leaves_[l].count > 0 ? radius_range_of_squares(least, most) : kNoRadii;
}

// Takes in the radius of a box that joins the leaf or has changed its size.
void Structure::widen_leaf_radii(LeafId l, const Obb& box) {
    leaf_radii_[l] = united(leaf_radii_[l], radius_range_of(box));
    contents_changed_ = true;
}

// Chooses a new frame for the leaf and writes all its boxes.
void Structure::rewrite_leaf(LeafId l) {
    Leaf& leaf = leaves_.edit(l);
    Aabb centers;
    double longest = 0.0;
    for (std::uint32_t lane = 0; lane < leaf.count; ++lane) {
        const Obb& box = items_.boxes()[slot_items_[l * kWidth + lane]];
        centers.include(box.center);
        longest = std::max(longest, longest_edge(box));
    }
    fit_frame(leaf, centers, longest);
    [[maybe_unused]] const std::size_t written = write_leaves({&l, 1});
    CROFTON_ASSERT(written == 1, "a frame around boxes must take them");
}

// Writes the boxes of leaves from the first on, while their frames take them; returns how many leaves.
std::size_t Structure::write_leaves(std::span<const LeafId> leaves) {
    return write_lanes(leaves_.edit_some(leaves), leaves, slot_items().data(), items_.boxes().data());
}

// Goes on copying arrays that grow.
void Structure::settle() {
    nodes_.settle();
    leaves_.settle();
    slot_items_.settle();
    item_slots_.settle();
}

// Writes an item's box and layers into its slot; all boxes in a new frame if the leaf's does not take it.
void Structure::write_item(ItemId item) {
    const std::uint32_t slot = item_slots_[item];
    write_layers(leaves_.edit(slot / kWidth), slot % kWidth, items_.layer_masks()[item]);
    if (!write_lane(leaves_.edit(slot / kWidth), slot % kWidth, items_.boxes()[item])) rewrite_leaf(slot / kWidth);
}

// Writes the bounds, layers and radii of all lanes from the children.
void Structure::refresh_node(NodeId n) {
    refresh_bounds(n);
    for (unsigned lane = 0; lane < nodes_[n].count; ++lane) copy_contents(n, lane);
    join_layers(nodes_.edit(n));
}

// Writes the bounds of all lanes in a new frame.
void Structure::refresh_bounds(NodeId n) {
    Node& node = nodes_.edit(n);
    Aabb bounds[kWidth], whole;
    for (std::uint32_t lane = 0; lane < node.count; ++lane) {
        bounds[lane] = bounds_below(node.child[lane], node.axes);
        if (!bounds[lane].is_empty()) whole.include(bounds[lane]);
    }
    fit_frame(node, whole, axes_of(node));
    for (std::uint32_t lane = 0; lane < node.count; ++lane) {
        [[maybe_unused]] const bool fits = write_lane(node, lane, bounds[lane], axes_of(node));
        CROFTON_ASSERT(fits, "a frame around bounds must take them");
    }
}

// Writes the layers and radii of one lane.
void Structure::refresh_contents(NodeId n, unsigned lane) {
    copy_contents(n, lane);
    join_layers(nodes_.edit(n));
}

void Structure::copy_contents(NodeId n, unsigned lane) {
    Node& node = nodes_.edit(n);
    const std::uint32_t child = node.child[lane];
    if (child & kLeafBit) {
        const Leaf& leaf = leaves_[child & ~kLeafBit];
        write_layers(node, lane, leaf.layers, leaf.layers, leaf.count);
        node_radii_[n].below[lane] = leaf_radii_[child & ~kLeafBit];
    } else {
        const Node& below = nodes_[child];
        write_layers(node, lane, below.layers_any, below.layers_all, below.count);
        RadiusRange range = kNoRadii;
        for (unsigned i = 0; i < below.count; ++i) range = united(range, node_radii_[child].below[i]);
        node_radii_[n].below[lane] = range;
    }
}

void Structure::join_layers(Node& node) {
    node.layers_every = ~std::uint32_t{0};
    for (unsigned i = 0; i < node.count; ++i) node.layers_every &= node.layers_all[i];
}

// How many items lie below the node; 0 where its leaves are not consecutive or an empty slot lies between full ones.
std::uint32_t Structure::items_without_gaps(NodeId n) const {
    const Node& node = nodes_[n];
    if (ranges_[n].count == 0) return 0;
    std::uint32_t items = 0;
    for (std::uint32_t lane = 0; lane < node.count; ++lane) {
        const std::uint32_t child = node.child[lane], id = child & ~kLeafBit;
        const LeafRange below = child & kLeafBit ? LeafRange{id, 1, leaf_counts_[id]} : ranges_[child];
        const bool has_gap = below.items == 0 || (lane + 1 < node.count && below.items < below.count * kWidth);
        if (has_gap) return 0;
        items += below.items;
    }
    return items;
}

}  // namespace crofton::boxtree
