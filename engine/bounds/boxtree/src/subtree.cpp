// SPDX-License-Identifier: MIT
#include "subtree.hpp"

#include <hwy/cache_control.h>
#include <algorithm>
#include <cmath>

namespace crofton::boxtree {
namespace {

struct Size {
    std::uint32_t nodes = 0, leaves = 0;
    unsigned height = 0;
};

// Returns the unit that a node of so many items is cut into multiples of: a leaf, or a node above leaves.
std::uint32_t unit_of(std::uint32_t items, std::uint32_t node_leaves) {
    return items <= kWidth * node_leaves ? kWidth : kWidth * node_leaves;
}

// How many nodes and leaves hold so many items; the top node is counted.
Size size_of_node(std::uint32_t items, std::uint32_t node_leaves) {
    if (items == 0) return {1, 0, 1};
    const auto part = static_cast<std::uint32_t>(items_a_part(items, unit_of(items, node_leaves)));
    const auto size_of_child = [&](std::uint32_t count) {
        if (count == 0) return Size{};
        return count <= kWidth ? Size{0, 1, 0} : size_of_node(count, node_leaves);
    };
    const Size each = size_of_child(std::min(part, items)), last = size_of_child(items % part);
    const std::uint32_t parts = items / part;
    return {1 + parts * each.nodes + last.nodes, (items + kWidth - 1) / kWidth, 1 + std::max(each.height, last.height)};
}

}  // namespace

BuildItem build_item(ItemId id, const Obb& box, const glm::dvec3& middle) {
    BuildItem item{};
    for (int j = 0; j < 3; ++j) {
        float projected_radius = 0.0f;
        for (int k = 0; k < 3; ++k) projected_radius += std::fabs(box.axes[k][j]) * box.half_extents[k];
        const auto center = static_cast<float>(box.center[j] - middle[j]);
        item.extreme[j] = projected_radius - center;
        item.extreme[4 + j] = center + projected_radius;
    }
    item.set_id(id);
    return item;
}

Subtree::Subtree(Range range, std::uint32_t node_leaves) : items(range) {
    const Size size = size_of_node(range.size(), node_leaves);
    nodes = size.nodes, leaves = size.leaves, height = size.height;
}

void SubtreeBuilder::start(const Subtree& subtree, std::span<const Obb> boxes, const glm::dvec3& middle,
                           const Topology& topology) {
    middle_ = middle;
    first_item_ = subtree.items.begin;
    next_node_ = subtree.first_node;
    next_leaf_ = subtree.first_leaf;
    const std::span<const ItemId> ids = std::span(topology.order).subspan(first_item_, subtree.items.size());
    items_.clear();
    items_.reserve(ids.size());
    // The boxes lie in the order of their ids, far from each other: prefetch them.
    constexpr std::size_t kAhead = 16;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        if (i + kAhead < ids.size()) {
            hwy::Prefetch(&boxes[ids[i + kAhead]]);
            hwy::Prefetch(&boxes[ids[i + kAhead]].half_extents);
        }
        items_.push_back(build_item(ids[i], boxes[ids[i]], middle));
    }
    splitter_.start(items_);
    tasks_.clear();
    tasks_.push_back({{0, subtree.items.size()}, subtree.parent, subtree.lane_in_parent});
}

bool SubtreeBuilder::step(std::size_t& budget, const Cost& cost, Orientation orientation, std::span<const Obb> boxes,
                          Topology& topology) {
    while (!tasks_.empty()) {
        if (budget == 0) return false;
        const std::size_t size = tasks_.back().range.size();
        if (orientation != Orientation::aligned && size > kWidth) {
            budget -= std::min(budget, 10 * size);
            if (!choose_axes(cost, orientation, boxes, topology)) continue;
        }
        const Task task = tasks_.back();
        tasks_.pop_back();
        if (task.parent != kNone && size <= kWidth) {
            add_leaf(task, topology);
            budget -= std::min<std::size_t>(budget, kWidth);
            continue;
        }
        const NodeId node = next_node_++;
        Topology::NodeRecord& record = topology.nodes[node];
        record.parent = task.parent;
        record.lane_in_parent = task.lane;
        record.axes = task.axes;
        record.leaves = {next_leaf_, (task.range.size() + kWidth - 1) / kWidth};
        if (task.parent != kNone) topology.nodes[task.parent].child[task.lane] = node;
        const Children children = splitter_.divide(task.range, unit_of(task.range.size(), topology.node_leaves), cost);
        record.count = children.count;
        budget -= std::min(budget, 4 * size);
        // Last in, first out: leaves come out in the order of the lanes.
        for (std::uint32_t lane = record.count; lane-- > 0;)
            tasks_.push_back({children.ranges[lane], node, lane, record.axes});
    }
    return true;
}

// Chooses axes for the last of the tasks, the next node; true when that is done. Then the items' coordinates and their
// three orders are along them.
bool SubtreeBuilder::choose_axes(const Cost& cost, Orientation orientation, std::span<const Obb> boxes,
                                 Topology& topology) {
    Task& task = tasks_.back();
    if (!chooser_.is_busy())
        chooser_.begin(items_, splitter_.order().subspan(task.range.begin, task.range.size()),
                       topology.axes[task.axes]);
    if (!chooser_.step(boxes, middle_, cost, orientation)) return false;
    if (!chooser_.has_found()) return true;
    const std::span<const std::uint32_t> indices = chooser_.indices();
    for (std::size_t i = 0; i < indices.size(); ++i) items_[indices[i]] = chooser_.items()[i];
    splitter_.take(task.range, chooser_.splitter(), indices);
    task.axes = chooser_.axes().rounding == 0.0 ? 0 : next_node_ + 1;
    if (task.axes != 0) topology.axes[task.axes] = chooser_.axes();
    return true;
}

void SubtreeBuilder::add_leaf(const Task& task, Topology& topology) {
    const LeafId leaf = next_leaf_++;
    const std::uint32_t first = first_item_ + task.range.begin;
    topology.leaves[leaf] = {first, task.range.size(), task.parent, task.lane};
    topology.nodes[task.parent].child[task.lane] = leaf | kLeafBit;
    for (std::uint32_t i = 0; i < task.range.size(); ++i)
        topology.order[first + i] = items_[splitter_.order()[task.range.begin + i]].id();
}

}  // namespace crofton::boxtree
