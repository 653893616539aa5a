// SPDX-License-Identifier: MIT
#include "subtree.hpp"

#include <hwy/cache_control.h>
#include <algorithm>
#include <cmath>
#include <utility>

#include "turned_bounds.hpp"

namespace crofton::boxtree {
namespace {

// Axes that save less than this share are not taken: it may be chance.
constexpr double kLeastGain = 1.0 / 64.0;

// The cost of visiting these items, if they are divided along these axes alone, down to leaves.
struct Below {
    Splitter& splitter;
    std::span<const BuildItem> items;
    const Cost& cost;
    double bounds = 0.0;  // the perimeters of all parts
    double inner = 0.0;   // of what is divided: the whole, and parts

    void divide(Range range) {
        BuildItem whole = kNothing;
        for (std::uint32_t i = range.begin; i < range.end; ++i) whole.include(items[splitter.order()[i]]);
        inner += cost(whole);
        const Children children = splitter.divide(range, kWidth, cost);
        for (std::uint32_t c = 0; c < children.count; ++c) {
            BuildItem part = kNothing;
            for (std::uint32_t i = children.ranges[c].begin; i < children.ranges[c].end; ++i)
                part.include(items[splitter.order()[i]]);
            bounds += cost(part);
            if (children.ranges[c].size() > kWidth) divide(children.ranges[c]);
        }
    }
    [[nodiscard]] double along(const Axes& axes, Orientation orientation) const {
        const bool pays = orientation == Orientation::automatic && axes.rounding != 0.0;
        return bounds + (pays ? kTurnCost * inner : 0.0);
    }
};

// The unit of budgets in the splitter's; what a leaf costs; choosing axes, an item of a node.
constexpr std::size_t kItemWork = 16, kLeafWork = 4 * kItemWork, kAxesWork = 10 * kItemWork;

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

BuildItem build_item(ItemId id, const Obb& box, const glm::dvec3& middle, const Axes& axes) {
    double center[3];
    for (int j = 0; j < 3; ++j) center[j] = box.center[j] - middle[j];
    BuildItem item{};
    for (unsigned k = 0; k < 3; ++k) {
        double projected_radius = 0.0;
        for (int i = 0; i < 3; ++i) {
            const double edge[3] = {box.axes[i].x, box.axes[i].y, box.axes[i].z};
            projected_radius += std::fabs(along(axes, k, edge)) * double{box.half_extents[i]};
        }
        const double at = along(axes, k, center);
        item.extreme[k] = static_cast<float>(projected_radius - at);
        item.extreme[4 + k] = static_cast<float>(at + projected_radius);
    }
    item.set_id(id);
    return item;
}

void AxesChooser::begin(std::span<const BuildItem> items, std::span<const std::uint32_t> indices, const Axes& now) {
    indices_.assign(indices.begin(), indices.end());
    items_.clear();
    for (const std::uint32_t index : indices) items_.push_back(items[index]);
    tried_[0] = now;
    tried_count_ = 0;
    found_ = false;
    next_ = 1;
}

bool AxesChooser::step(std::span<const Obb> boxes, const glm::dvec3& middle, const Cost& cost,
                       Orientation orientation) {
    const std::size_t count = items_.size();
    while (next_ <= kSamples + 2) {
        Axes axes;  // the world's second
        const std::size_t turn = next_++;
        if (turn == 1) axes = tried_[0];
        if (turn > 2) axes = axes_of(boxes[items_[count * (2 * turn - 5) / (2 * kSamples)].id()].axes);
        if (std::any_of(tried_, tried_ + tried_count_, [&](const Axes& other) { return are_alike(axes, other); }))
            continue;
        tried_[tried_count_++] = axes;
        if (turn > 1)
            for (BuildItem& item : items_) item = build_item(item.id(), boxes[item.id()], middle, axes);
        try_axes(axes, cost, orientation);
        return false;
    }
    if (found_) splitter_.start(best_items_);
    next_ = 0;
    return true;
}

void AxesChooser::try_axes(const Axes& axes, const Cost& cost, Orientation orientation) {
    splitter_.start(items_);
    Below below{splitter_, items_, cost};
    below.divide({0, static_cast<std::uint32_t>(items_.size())});
    const double value = below.along(axes, orientation);
    if (tried_count_ == 1) {
        least_ = value - kLeastGain * below.bounds;
    } else if (value < least_) {
        least_ = value;
        found_ = true;
        best_axes_ = axes;
        best_items_.assign(items_.begin(), items_.end());
    }
}

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

void SubtreeBuilder::start(const Subtree& subtree, const glm::dvec3& middle) {
    middle_ = middle;
    first_item_ = subtree.items.begin;
    item_count_ = subtree.items.size();
    next_node_ = subtree.first_node;
    next_leaf_ = subtree.first_leaf;
    divided_ = kNone;
    items_.clear();
    items_.reserve(item_count_);
    tasks_.clear();
    tasks_.push_back({{0, item_count_}, subtree.parent, subtree.lane_in_parent});
}

// Copies the items, in parts that the work allows; true when all are there, and sorted.
bool SubtreeBuilder::gather(std::size_t& work, std::span<const Obb> boxes, const Topology& topology) {
    if (items_.size() == item_count_) return splitter_.sort_on(work);
    const std::size_t most = std::max<std::size_t>(work / kItemWork, 1), begin = items_.size(),
                      end = std::min<std::size_t>(item_count_, begin + std::min<std::size_t>(most, item_count_));
    const std::span<const ItemId> ids = std::span(topology.order).subspan(first_item_, end);
    // The boxes lie in the order of their ids, far from each other: prefetch them.
    constexpr std::size_t kAhead = 16;
    for (std::size_t i = begin; i < end; ++i) {
        if (i + kAhead < end) {
            hwy::Prefetch(&boxes[ids[i + kAhead]]);
            hwy::Prefetch(&boxes[ids[i + kAhead]].half_extents);
        }
        items_.push_back(build_item(ids[i], boxes[ids[i]], middle_));
    }
    gathered_ += end - begin;
    work -= std::min(work, (end - begin) * kItemWork);
    if (end < item_count_) return false;
    splitter_.begin(items_);
    return splitter_.sort_on(work);
}

bool SubtreeBuilder::step(std::size_t& budget, const Cost& cost, Orientation orientation, std::span<const Obb> boxes,
                          Topology& topology) {
    std::size_t work = std::min(budget, ~std::size_t{0} / kItemWork) * kItemWork;
    const bool done = step_on(work, cost, orientation, boxes, topology);
    budget = work / kItemWork;
    return done;
}

bool SubtreeBuilder::step_on(std::size_t& work, const Cost& cost, Orientation orientation, std::span<const Obb> boxes,
                             Topology& topology) {
    if (!gather(work, boxes, topology)) return false;
    for (;;) {
        if (divided_ != kNone) {
            if (!splitter_.divide_on(cost, work)) return false;
            add_children(topology);
        }
        if (tasks_.empty()) return true;
        if (work == 0) return false;
        const std::size_t size = tasks_.back().range.size();
        if (orientation != Orientation::aligned && size > kWidth) {
            work -= std::min(work, kAxesWork * size);
            if (!choose_axes(cost, orientation, boxes, topology)) continue;
        }
        const Task task = tasks_.back();
        tasks_.pop_back();
        if (task.parent != kNone && size <= kWidth) {
            add_leaf(task, topology);
            work -= std::min(work, kLeafWork);
        } else {
            begin_node(task, topology);
        }
    }
}

void SubtreeBuilder::begin_node(const Task& task, Topology& topology) {
    divided_ = next_node_++;
    Topology::NodeRecord& record = topology.nodes[divided_];
    record.parent = task.parent;
    record.lane_in_parent = task.lane;
    record.axes = task.axes;
    record.leaves = {next_leaf_, (task.range.size() + kWidth - 1) / kWidth};
    if (task.parent != kNone) topology.nodes[task.parent].child[task.lane] = divided_;
    splitter_.begin_division(task.range, unit_of(task.range.size(), topology.node_leaves));
}

// The parts of the node that has been divided become tasks.
void SubtreeBuilder::add_children(Topology& topology) {
    const Children& children = splitter_.children();
    Topology::NodeRecord& record = topology.nodes[divided_];
    record.count = children.count;
    // Last in, first out: leaves come out in the order of the lanes.
    for (std::uint32_t lane = record.count; lane-- > 0;)
        tasks_.push_back({children.ranges[lane], divided_, lane, record.axes});
    divided_ = kNone;
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
