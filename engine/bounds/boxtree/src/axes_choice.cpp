// SPDX-License-Identifier: MIT
#include "axes_choice.hpp"

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

}  // namespace crofton::boxtree
