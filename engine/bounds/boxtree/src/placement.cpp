// SPDX-License-Identifier: MIT
#include "placement.hpp"

#include <hwy/cache_control.h>
#include <algorithm>
#include <array>
#include <crofton/boxtree/radius_range.hpp>
#include <crofton/geometry/float_lanes.hpp>
#include <cstring>
#include <limits>
#include <utility>

#include "bounds.hpp"
#include "partition.hpp"
#include "turned_bounds.hpp"

namespace crofton::boxtree {

using detail::Lanes4;

// Fills the gap that an item leaves with the leaf's last item.
void Placement::vacate(ItemId item) {
    const std::uint32_t slot = structure_.item_slots_[item];
    const LeafId l = slot / kWidth;
    Leaf& leaf = leaves_.edit(l);
    const std::uint32_t last = --leaf.count;
    structure_.leaf_counts_[l] = static_cast<std::uint8_t>(leaf.count);
    const ItemId moved = structure_.slot_items_[l * kWidth + last];
    if (moved != item) {
        structure_.slot_items_.set(slot, moved);
        structure_.item_slots_.set(moved, slot);
        structure_.write_item(moved);
    }
    clear_lane(leaf, last);
    structure_.slot_items_.set(l * kWidth + last, kNone);
    structure_.item_slots_.set(item, kNone);
    invalidate_item_count(leaf.parent);
    structure_.contents_changed_ = true;
    structure_.marks_.mark(slot);
}

void Placement::place(ItemId item) {
    put(item);
    structure_.settle();
}

void Placement::put(ItemId item) {
    if (nodes_[0].count == 0) add_child(0, add_leaf() | kLeafBit);
    LeafId l = best_leaf(structure_.items_.boxes()[item]);
    if (leaves_[l].count == kWidth) {
        const LeafId more = one_leaf_more(leaves_[l].parent);
        if (more == kNone) return split_leaf(l, item);
        l = more;
    }
    Leaf& leaf = leaves_.edit(l);
    const std::uint32_t slot = l * kWidth + leaf.count++;
    structure_.leaf_counts_[l] = static_cast<std::uint8_t>(leaf.count);
    structure_.slot_items_.set(slot, item);
    structure_.item_slots_.set(item, slot);
    structure_.write_item(item);
    structure_.leaf_radii_[l] = united(structure_.leaf_radii_[l], radius_range_of(structure_.items_.boxes()[item]));
    invalidate_item_count(leaf.parent);
    refresh_above(l | kLeafBit);
}

LeafId Placement::add_leaf() {
    const auto fresh = static_cast<LeafId>(leaves_.size());
    leaves_.make_room(1);
    make_room_for(structure_.leaf_counts_, 1);
    make_room_for(structure_.leaf_radii_, 1);
    structure_.slot_items_.make_room(kWidth);
    leaves_.append(Leaf());
    clear(leaves_.edit(fresh));
    structure_.leaf_counts_.push_back(0);
    structure_.leaf_radii_.push_back(kNoRadii);
    structure_.slot_items_.append(kWidth, kNone);
    structure_.marks_.add_leaf();
    return fresh;
}

// The lane for the box to go to: the one whose criterion grows least, and the smallest of those. `box` lies along the
// node's axes. In the node's units and in float: a choice between lanes that grow alike is worth no more digits.
unsigned Placement::best_lane(const Node& node, const Aabb& box) const {
    constexpr double kFar = 1e9;  // units; a node reaches no farther than 2^16
    const Axes& axes = structure_.axes_of(node);
    const double unit = double{node.unit};
    float box_low[3], box_high[3];
    for (unsigned j = 0; j < 3; ++j) {
        const double origin = node.axes == 0 ? node.origin[j] : along(axes, j, node.origin);
        box_low[j] = static_cast<float>(std::clamp((box.min[static_cast<int>(j)] - origin) / unit, -kFar, kFar));
        box_high[j] = static_cast<float>(std::clamp((box.max[static_cast<int>(j)] - origin) / unit, -kFar, kFar));
    }
    const Cost cost(structure_.criterion_);
    const double volume = cost.volume * unit * unit, area = cost.area * unit,
                 most = std::max({volume, area, cost.edges});
    const auto of_volume = static_cast<float>(volume / most), of_area = static_cast<float>(area / most),
               of_edges = static_cast<float>(cost.edges / most);
    const ChildEnds ends = ends_of(node);
    float sizes[kWidth], growths[kWidth];
    const Lanes4 volumes = detail::all_lanes(of_volume), areas = detail::all_lanes(of_area),
                 edges = detail::all_lanes(of_edges);
    const auto value = [&](const Lanes4& x, const Lanes4& y, const Lanes4& z) {
        return volumes * (x * y * z) + areas * (x * y + y * z + z * x) + edges * (x + y + z);
    };
    for (unsigned first = 0; first < kWidth; first += 4) {
        Lanes4 old[3], grown[3];
        for (unsigned j = 0; j < 3; ++j) {
            const Lanes4 low = detail::load4(reinterpret_cast<const char*>(ends.low[j] + first)),
                         high = detail::load4(reinterpret_cast<const char*>(ends.high[j] + first));
            old[j] = detail::larger(high - low, detail::all_lanes(0.0f));
            grown[j] = detail::larger(detail::all_lanes(box_high[j]), high) -
                       detail::lesser(detail::all_lanes(box_low[j]), low);
        }
        const Lanes4 size = value(old[0], old[1], old[2]), growth = value(grown[0], grown[1], grown[2]) - size;
        std::memcpy(sizes + first, &size, sizeof size);
        std::memcpy(growths + first, &growth, sizeof growth);
    }
    unsigned best = 0;
    for (unsigned lane = 1; lane < node.count; ++lane) {
        const bool same = growths[lane] == growths[best], smaller = sizes[lane] < sizes[best];
        if (growths[lane] < growths[best] || (same && smaller)) best = lane;
    }
    return best;
}

// Goes down from the root into the best lane of each node.
LeafId Placement::best_leaf(const Obb& box) const {
    std::uint32_t axes = nodes_[0].axes;
    Aabb bounds = bounds_along(structure_.axes_of(nodes_[0]), box);
    for (NodeId n = 0;;) {
        const Node& node = nodes_[n];
        if (std::exchange(axes, node.axes) != node.axes) bounds = bounds_along(structure_.axes_of(node), box);
        const std::uint32_t child = node.child[best_lane(node, bounds)];
        if (child & kLeafBit) return child & ~kLeafBit;
        n = child;
    }
}

// Where an item goes whose best leaf is full: of a node as it was built, into one leaf more, while that has room; kNone
// says to split the full one. Splitting it reads all its items, which lie far from each other, and leaves two halves;
// until many items have come, one leaf that is as wide as the node costs a query no more than they do.
LeafId Placement::one_leaf_more(NodeId parent) {
    const Node& node = nodes_[parent];
    if (node.only_leaves == 0 || empty_leaf_of(parent) != kNone) return kNone;
    if (node.count < kWidth && structure_.ranges_[parent].count != 0) {
        const LeafId fresh = free_leaf();
        clear(leaves_.edit(fresh));
        structure_.leaf_radii_[fresh] = kNoRadii;
        add_child(parent, fresh | kLeafBit);
        return fresh;
    }
    const std::uint32_t last = node.count - 1;
    for (unsigned lane = 1; lane < last; ++lane)
        if (node.child[lane] != node.child[0] + lane) return kNone;
    const LeafId more = node.child[last] & ~kLeafBit;
    return structure_.leaf_counts_[more] < kWidth ? more : kNone;
}

// An empty leaf of the node; kNone if it has none.
LeafId Placement::empty_leaf_of(NodeId parent) const {
    const Node& node = nodes_[parent];
    for (unsigned lane = 0; lane < node.count; ++lane)
        if ((node.child[lane] & kLeafBit) != 0 && structure_.leaf_counts_[node.child[lane] & ~kLeafBit] == 0)
            return node.child[lane] & ~kLeafBit;
    return kNone;
}

// A leaf in no node: one that all items have left, taken from its node, so that a tree whose items come and go does not
// grow, or else a new one. Looks at a part of the leaves, the next part the next time.
LeafId Placement::free_leaf() {
    constexpr std::size_t kLooks = 1024;
    const Vector<std::uint8_t>& counts = structure_.leaf_counts_;
    const std::size_t begin = structure_.next_free_leaf_, end = std::min(begin + kLooks, counts.size());
    const void* const empty = std::memchr(counts.data() + begin, 0, end - begin);
    structure_.next_free_leaf_ = end < counts.size() ? end : 0;
    if (empty == nullptr) return add_leaf();
    const auto l = static_cast<LeafId>(static_cast<const std::uint8_t*>(empty) - counts.data());
    structure_.next_free_leaf_ = (l + std::size_t{1}) % counts.size();
    if (nodes_[leaves_[l].parent].count <= 2) return add_leaf();  // a node keeps two children
    remove_child(leaves_[l].parent, leaves_[l].lane_in_parent);
    return l;
}

// Asks the memory for what making a leaf of these items needs.
void Placement::fetch_items(const ItemId* items) const {
    for (unsigned lane = 0; lane < kWidth; ++lane) {
        const char* const box = reinterpret_cast<const char*>(&structure_.items_.boxes()[items[lane]]);
        hwy::Prefetch(box);
        hwy::Prefetch(box + sizeof(Obb) - 1);
        hwy::Prefetch(&structure_.items_.layer_masks()[items[lane]]);
        hwy::Prefetch(&structure_.item_slots_[items[lane]]);
    }
}

// Moves half of a full leaf's items to a new leaf next to it, with one more item: the half whose centres it spreads
// less.
void Placement::split_leaf(LeafId l, ItemId more) {
    fetch_items(&structure_.slot_items_[l * kWidth]);
    BuildItem items[kWidth];
    const auto build_item = [&](ItemId item) {
        const Obb& box = structure_.items_.boxes()[item];
        BuildItem built{};
        for (int j = 0; j < 3; ++j) {
            const auto center = static_cast<float>(box.center[j] - leaves_[l].origin[j]);
            built.extreme[j] = -center;
            built.extreme[4 + j] = center;
        }
        built.set_id(item);
        return built;
    };
    for (unsigned lane = 0; lane < kWidth; ++lane) items[lane] = build_item(structure_.slot_items_[l * kWidth + lane]);
    halve(items);
    const Cost cost(structure_.criterion_);
    const BuildItem one_more = build_item(more);
    double growths[2];
    for (unsigned side = 0; side < 2; ++side) {
        BuildItem half = kNothing;
        for (unsigned i = 0; i < kWidth / 2; ++i) half.include(items[side * kWidth / 2 + i]);
        growths[side] = -cost(half);
        half.include(one_more);
        growths[side] += cost(half);
    }
    const NodeId parent = leaves_[l].parent;
    const LeafId empty = empty_leaf_of(parent), other = empty != kNone ? empty : free_leaf();
    const LeafId both[2] = {l, other};
    const unsigned taker = growths[1] < growths[0] ? 1 : 0;
    for (unsigned side = 0; side < 2; ++side) {
        ItemId ids[kWidth / 2 + 1];
        for (unsigned i = 0; i < kWidth / 2; ++i) ids[i] = items[side * kWidth / 2 + i].id();
        ids[kWidth / 2] = more;
        const std::size_t count = kWidth / 2 + (side == taker ? 1 : 0);
        make_leaf(both[side], {ids, count}, parent, leaves_[both[side]].lane_in_parent);
    }
    invalidate_item_count(parent);
    if (empty == kNone) add_child(parent, other | kLeafBit);
    refresh_above_both(l | kLeafBit, other | kLeafBit);
}

void Placement::make_leaf(LeafId l, std::span<const ItemId> items, NodeId parent, std::uint32_t lane_in_parent) {
    Leaf& leaf = leaves_.edit(l);
    clear(leaf);
    leaf.parent = parent;
    leaf.lane_in_parent = lane_in_parent;
    for (unsigned lane = 0; lane < kWidth; ++lane) structure_.slot_items_.set(l * kWidth + lane, kNone);
    for (const ItemId item : items) {
        const std::uint32_t slot = l * kWidth + leaf.count++;
        structure_.slot_items_.set(slot, item);
        structure_.item_slots_.set(item, slot);
    }
    structure_.leaf_counts_[l] = static_cast<std::uint8_t>(leaf.count);
    structure_.write_leaf_layers(l);
    structure_.write_leaf_radii(l);
    structure_.rewrite_leaf(l);
}

void Placement::link(NodeId parent, unsigned lane, std::uint32_t child) {
    nodes_.edit(parent).child[lane] = child;
    if (child & kLeafBit) {
        Leaf& leaf = leaves_.edit(child & ~kLeafBit);
        leaf.parent = parent;
        leaf.lane_in_parent = lane;
    } else {
        nodes_.edit(child).parent = parent;
        nodes_.edit(child).lane_in_parent = lane;
        nodes_.edit(parent).only_leaves = 0;
    }
}

void Placement::add_child(NodeId parent, std::uint32_t child) {
    while (nodes_[parent].count == kWidth) parent = split_node(parent);
    Node& node = nodes_.edit(parent);
    node.count++;
    link(parent, node.count - 1, child);
    // The new child's leaves lie elsewhere in memory, so those below here, and above, are no longer consecutive.
    for (NodeId n = parent; n != kNone; n = nodes_[n].parent) structure_.ranges_[n] = {};
}

// Requires more than two children, of which this one has no items.
void Placement::remove_child(NodeId parent, unsigned lane) {
    std::uint32_t children[kWidth];
    unsigned count = 0;
    for (unsigned i = 0; i < nodes_[parent].count; ++i)
        if (i != lane) children[count++] = nodes_[parent].child[i];
    make_node(parent, {children, count}, nodes_[parent].parent, nodes_[parent].lane_in_parent, nodes_[parent].axes);
    structure_.refresh_node(parent);
    for (NodeId n = parent; n != kNone; n = nodes_[n].parent) structure_.ranges_[n] = {};
    refresh_above(parent);
}

// Half of a full node's children go to a new node; returns the one of the two that the caller may add to. Splitting the
// root makes a new level below node 0.
NodeId Placement::split_node(NodeId n) {
    BuildItem items[kWidth];
    for (unsigned lane = 0; lane < kWidth; ++lane) {
        items[lane] = {};
        for (unsigned j = 0; j < 3; ++j) {
            items[lane].extreme[j] = -static_cast<float>(low_of(nodes_[n], lane, j));
            items[lane].extreme[4 + j] = static_cast<float>(high_of(nodes_[n], lane, j));
        }
        items[lane].set_id(lane);
    }
    halve(items);
    const Node whole = nodes_[n];
    const NodeRadii radii = structure_.node_radii_[n];
    const auto make_half = [&](unsigned side, NodeId half, NodeId parent, unsigned lane_in_parent) {
        unsigned lanes[kWidth / 2];  // of the whole
        for (unsigned i = 0; i < kWidth / 2; ++i) lanes[i] = items[side * kWidth / 2 + i].id();
        make_part(half, whole, radii, lanes, parent, lane_in_parent);
    };
    const auto fresh = static_cast<NodeId>(nodes_.size());
    nodes_.make_room(2);
    make_room_for(structure_.ranges_, 2);
    make_room_for(structure_.node_radii_, 2);
    if (n == 0) {
        nodes_.append(2, Node());
        structure_.ranges_.resize(fresh + 2);
        structure_.node_radii_.resize(fresh + 2);
        make_half(0, fresh, 0, 0);
        make_half(1, fresh + 1, 0, 1);
        const std::uint32_t both[2] = {fresh, fresh + 1};
        make_node(0, both, kNone, 0, whole.axes);
        ++structure_.height_;
        structure_.refresh_node(0);
        return fresh;
    }
    nodes_.append(Node());
    structure_.ranges_.emplace_back();
    structure_.node_radii_.emplace_back();
    make_half(0, n, whole.parent, whole.lane_in_parent);
    make_half(1, fresh, whole.parent, 0);
    add_child(whole.parent, fresh);
    refresh_above_both(n, fresh);
    return n;
}

// Makes a node of some lanes of another. It keeps the other's frame, so that bounds need not be computed again.
void Placement::make_part(NodeId n, const Node& whole, const NodeRadii& radii, std::span<const unsigned> lanes,
                          NodeId parent, unsigned lane_in_parent) {
    std::uint32_t children[kWidth];
    for (std::size_t i = 0; i < lanes.size(); ++i) children[i] = whole.child[lanes[i]];
    make_node(n, {children, lanes.size()}, parent, lane_in_parent, whole.axes);
    Node& part = nodes_.edit(n);
    std::copy_n(whole.origin, 3, part.origin);
    part.unit = whole.unit;
    part.per_quantum = whole.per_quantum;
    part.l1_radius = whole.l1_radius;
    part.rounding = whole.rounding;
    for (std::size_t i = 0; i < lanes.size(); ++i) {
        part.middle_xy[i] = whole.middle_xy[lanes[i]];
        part.middle_half_z[i] = whole.middle_half_z[lanes[i]];
        part.half_xy[i] = whole.half_xy[lanes[i]];
        part.layers_any[i] = whole.layers_any[lanes[i]];
        part.layers_all[i] = whole.layers_all[lanes[i]];
        structure_.node_radii_[n].below[i] = radii.below[lanes[i]];
    }
    structure_.join_layers(part);
}

void Placement::make_node(NodeId n, std::span<const std::uint32_t> children, NodeId parent, unsigned lane_in_parent,
                          std::uint32_t axes) {
    Node& node = nodes_.edit(n);
    clear(node);
    node.axes = axes;
    structure_.ranges_[n] = {};
    node.parent = parent;
    node.lane_in_parent = lane_in_parent;
    node.only_leaves = 1;
    for (const std::uint32_t child : children) link(n, node.count++, child);
}

// Brings the lanes up to date on the path from a changed leaf or node to the root. As in a refit, other lanes and the
// frame stay where the frame takes the bound. Where all bounds lie along the same axes, the path ends at the first node
// in which nothing changes, as those above depend on it alone. Bounds along other axes are made from the leaves, so
// there the path continues to the root.
void Placement::refresh_above(std::uint32_t first) {
    const bool turned = structure_.axes_.size() > 1;
    std::uint32_t child = first;
    for (Place place = place_of(child); place.node != kNone; place = place_of(child)) {
        const NodeId n = place.node;
        const Node before = nodes_[n];
        const NodeRadii radii_before = structure_.node_radii_[n];
        if (!write_path_lane(place, first, child)) structure_.refresh_bounds(n);
        structure_.refresh_contents(n, place.lane);
        if (!turned && std::memcmp(&before, &nodes_[n], sizeof(Node)) == 0 &&
            std::memcmp(&radii_before, &structure_.node_radii_[n], sizeof(NodeRadii)) == 0)
            return;
        child = n;
    }
}

// The same above both halves of what has been split. Below one node the first needs its lane alone: the second's, which
// was empty, changes that node, so that its path continues. Bounds along other axes take in either half by itself.
void Placement::refresh_above_both(std::uint32_t first, std::uint32_t second) {
    const Place place = place_of(first);
    if (place.node != place_of(second).node || structure_.axes_.size() > 1) {
        refresh_above(first);
    } else {
        if (!write_path_lane(place, first, first)) structure_.refresh_bounds(place.node);
        structure_.refresh_contents(place.node, place.lane);
    }
    refresh_above(second);
}

// Writes the bound of what lies below `child` into its lane; false if the node's frame does not take it. Where child's
// own bounds lie along other axes, bounding all leaves below it again would cost too much. Then the lane's bound grows
// by what has changed. That is the bound of the highest node on the path from `first` whose bounds lie along the lane's
// axes, or else of `first`.
bool Placement::write_path_lane(Place above, std::uint32_t first, std::uint32_t child) {
    Node& node = nodes_.edit(above.node);
    const Axes& axes = structure_.axes_of(node);
    if (child == first || nodes_[child].axes == node.axes)
        return write_lane(node, above.lane, structure_.bounds_below(child, node.axes), axes);
    std::uint32_t changed = first;
    for (NodeId n = place_of(first).node; n != child; n = nodes_[n].parent)
        if (nodes_[n].axes == node.axes) changed = n;
    const Aabb before = bounds_of_lane(node, above.lane, axes);
    Aabb bounds = before;
    bounds.include(structure_.bounds_below(changed, node.axes));
    const bool held = bounds.min == before.min && bounds.max == before.max;
    return held || write_lane(node, above.lane, bounds, axes);
}

Placement::Place Placement::place_of(std::uint32_t child) const {
    if (child & kLeafBit) {
        const Leaf& leaf = leaves_[child & ~kLeafBit];
        return {leaf.parent, leaf.lane_in_parent};
    }
    return {nodes_[child].parent, nodes_[child].lane_in_parent};
}

// Notes that the leaves below this node, and below those above it, may have gaps.
void Placement::invalidate_item_count(NodeId n) {
    for (; n != kNone && structure_.ranges_[n].items != 0; n = nodes_[n].parent) structure_.ranges_[n].items = 0;
}

}  // namespace crofton::boxtree
