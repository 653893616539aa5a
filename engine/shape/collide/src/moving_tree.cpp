// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/collide/moving_tree.hpp>
#include <crofton/geometry/finite.hpp>
#include <limits>

#include "item_tree.hpp"
#include "leaf_bounds.hpp"
#include "space_order.hpp"

namespace crofton::collide {

struct MovingTree::State {
    SpaceOrder order;
    ItemTree tree;
    glm::dvec3 origin{0.0};

    void refit(std::span<const Obb> boxes) {
        for (std::size_t leaf = 0; leaf < tree.leaf_count(); ++leaf) {
            const std::span<const std::uint32_t> items = tree.items_of(leaf);
            if (items.empty()) continue;
            bound_items(boxes, items, tree.items_of(std::min(leaf + 2, tree.leaf_count() - 1)), origin,
                        tree.leaf(leaf));
            tree.clear_unused(leaf);
        }
        tree.bound_all();
    }
    void sort(std::span<const Obb> boxes) {
        tree.clear();
        tree.resize(boxes.size());
        order.sort(boxes);
        tree.arrange(order.items());
        refit(boxes);
        tree.remember_extents();
    }
};

MovingTree::MovingTree() : state_(Owner<State>::make()) {}
MovingTree::~MovingTree() = default;
MovingTree::MovingTree(MovingTree&&) noexcept = default;
MovingTree& MovingTree::operator=(MovingTree&&) noexcept = default;

void MovingTree::update(std::span<const Obb> boxes) {
    constexpr std::size_t kFewNew = 8;  // one in so many
    State& s = *state_;
    s.origin = middle_of(boxes);
    const std::size_t before = s.tree.item_count(), size = boxes.size();
    if (std::max(before, size) - std::min(before, size) > size / kFewNew) return s.sort(boxes);
    for (std::size_t item = size; item < before; ++item) s.tree.remove(static_cast<std::uint32_t>(item));
    s.tree.resize(size);
    s.refit(boxes);
    for (std::size_t item = before; item < size; ++item) {
        const auto only = static_cast<std::uint32_t>(item);
        BoundBlock bounds;
        bound_items(boxes, {&only, 1}, {}, s.origin, bounds);
        s.tree.insert(only, lane_of(bounds, 0));
    }
    if (s.tree.is_worn()) s.sort(boxes);
}

// What is not finite is left to who asks: all boxes may be met.
std::size_t MovingTree::along(const Ray& ray, std::span<std::uint32_t> indices) const {
    const glm::dvec3 origin = ray.origin - state_->origin;
    BlockRay lanes;
    for (int i = 0; i < 3; ++i) {
        lanes.origin[i] = origin[i];
        lanes.inverse[i] = 1.0 / ray.direction[i];
        lanes.is_flat[i] = !std::isfinite(lanes.inverse[i]);
        if (!std::isfinite(origin[i]) || !std::isfinite(ray.direction[i])) return indices.size() + 1;
    }
    if (!(ray.max_t >= 0.0)) return indices.size() + 1;
    lanes.max_t = std::min(ray.max_t * (1.0 + 1e-11), std::numeric_limits<double>::max());
    return find_along(state_->tree.view(), lanes, indices.data(), indices.size());
}

std::size_t MovingTree::near(const Aabb& bounds, double distance, std::span<std::uint32_t> indices) const {
    LaneBounds lanes;
    for (int i = 0; i < 3; ++i) {
        const double low = bounds.min[i] - state_->origin[i] - distance,
                     high = bounds.max[i] - state_->origin[i] + distance,
                     slack = 1e-11 * (std::abs(bounds.min[i]) + std::abs(bounds.max[i]) + std::abs(state_->origin[i]) +
                                      distance);
        if (!(low - slack > -1e37) || !(high + slack < 1e37)) return indices.size() + 1;
        lanes.low[i] = std::nextafter(static_cast<float>(low - slack), -std::numeric_limits<float>::infinity());
        lanes.high[i] = std::nextafter(static_cast<float>(high + slack), std::numeric_limits<float>::infinity());
    }
    return find_near(state_->tree.view(), lanes, indices.data(), indices.size());
}

}  // namespace crofton::collide
