// SPDX-License-Identifier: MIT
#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/collide/moving_tree.hpp>
#include <crofton/geometry/finite.hpp>
#include <limits>
#include <utility>

#include "item_tree.hpp"
#include "leaf_bounds.hpp"
#include "space_order.hpp"

namespace crofton::collide {

struct MovingTree::State {
    struct Stray {
        std::uint32_t item;
        LaneBounds bounds;
    };

    SpaceOrder order;
    ItemTree tree{ItemTree::FullLeaves::split};
    glm::dvec3 origin{0.0};
    Vector<Stray> strays;  // items that jumped out of their leaf: often another box has got the index

    // New bounds of all leaves. Finds strays if the boxes had others before, around an origin that lies `shift` from
    // here.
    void bound_leaves(std::span<const Obb> boxes, const float (*shift)[3]) {
        strays.clear();
        const float usual = tree.mean_leaf_extent();
        for (std::size_t leaf = 0; leaf < tree.leaf_count(); ++leaf) {
            const std::span<const std::uint32_t> items = tree.items_of(leaf);
            if (items.empty()) continue;
            BoundBlock bounds;
            bound_items(boxes, items, tree.items_of(std::min(leaf + 2, tree.leaf_count() - 1)), origin, bounds);
            BoundBlock& kept = tree.leaf(leaf);
            std::uint32_t jumped =
                shift != nullptr ? lanes_that_jumped(kept, bounds, *shift, std::max(usual, tree.leaf_extent(leaf))) &
                                       ((1u << items.size()) - 1u)
                                 : 0u;
            kept = bounds;
            for (; jumped != 0; jumped &= jumped - 1) {
                const auto lane = static_cast<std::size_t>(std::countr_zero(jumped));
                strays.push_back({items[lane], lane_of(bounds, lane)});
            }
            tree.clear_unused(leaf);
        }
    }
    void sort(std::span<const Obb> boxes) {
        tree.clear();
        tree.resize(boxes.size());
        order.sort(boxes);
        tree.arrange(order.items());
        bound_leaves(boxes, nullptr);
        tree.bound_all();
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
    const glm::dvec3 origin_before = std::exchange(s.origin, middle_of(boxes));
    const std::size_t before = s.tree.item_count(), size = boxes.size();
    if (std::max(before, size) - std::min(before, size) > size / kFewNew) return s.sort(boxes);
    for (std::size_t item = size; item < before; ++item) s.tree.remove(static_cast<std::uint32_t>(item));
    s.tree.resize(size);
    const glm::dvec3 way = s.origin - origin_before;
    const float shift[3] = {static_cast<float>(way.x), static_cast<float>(way.y), static_cast<float>(way.z)};
    s.bound_leaves(boxes, &shift);
    if (s.strays.size() > size / kFewNew) return s.sort(boxes);
    for (const State::Stray& stray : s.strays) s.tree.remove(stray.item);
    s.tree.bound_all();
    if (s.tree.is_worn()) return s.sort(boxes);
    for (const State::Stray& stray : s.strays) s.tree.insert(stray.item, stray.bounds);
    for (std::size_t item = before; item < size; ++item) {
        const auto only = static_cast<std::uint32_t>(item);
        BoundBlock bounds;
        bound_items(boxes, {&only, 1}, {}, s.origin, bounds);
        s.tree.insert(only, lane_of(bounds, 0));
    }
}

namespace {

// Visits the items of lanes that begin before the limit, nearest first; the visitor returns the new limit, and ends the
// walk by a negative one. lanes_of(block, limit, entries): those lanes of a block, and where they begin.
template <class Number, class LanesOf, class Visit>
void walk_nearest_first(const BoundTree& tree, Number limit, LanesOf lanes_of, Visit visit) {
    struct Step {
        Number entry;
        std::uint32_t height, child;  // 0: an item; else a block of the level below
    };
    Step stack[(kMaxLevels + 1) * kBoxBlock];
    std::size_t size = 0;
    stack[size++] = {Number(0), static_cast<std::uint32_t>(tree.level_count), tree.root};
    while (size > 0) {
        const Step step = stack[--size];
        if (step.entry > limit) continue;
        if (step.height == 0) {
            limit = visit(step.child);
            if (!(limit >= Number(0))) return;
            continue;
        }
        const std::uint32_t level = step.height - 1;
        const std::uint32_t* const children = tree.children[level] + step.child * kBoxBlock;
        Number entries[kBoxBlock];
        const std::size_t base = size;
        for (std::uint32_t lanes = lanes_of(tree.levels[level][step.child], limit, entries); lanes != 0;
             lanes &= lanes - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
            std::size_t place = size++;
            for (; place > base && stack[place - 1].entry < entries[lane]; --place) stack[place] = stack[place - 1];
            stack[place] = {entries[lane], level, children[lane]};
        }
    }
}

// Beyond x on this side, also where x rounds to 0.
float rounded_out(double x, float side) {
    const auto rounded = static_cast<float>(x);
    return rounded + side * (0x1p-22f * std::abs(rounded) + 1e-37f);
}

// What is not finite is left to who asks: all boxes may be met.
void visit_all(std::size_t count, MovingTree::Visitor visit) {
    for (std::size_t item = 0; item < count; ++item)
        if (!(visit(static_cast<std::uint32_t>(item)) >= 0.0)) return;
}

}  // namespace

void MovingTree::visit_along(const Ray& ray, const glm::dvec3& half_size, Visitor visit) const {
    if (!(ray.max_t >= 0.0)) return;
    const ItemTree& tree = state_->tree;
    const glm::dvec3 origin = ray.origin - state_->origin;
    BlockRay lanes;
    for (int i = 0; i < 3; ++i) {
        lanes.origin[i] = origin[i];
        lanes.inverse[i] = 1.0 / ray.direction[i];
        lanes.half_size[i] = half_size[i];
        lanes.is_flat[i] = !std::isfinite(lanes.inverse[i]);
        if (!std::isfinite(origin[i]) || !std::isfinite(ray.direction[i])) return visit_all(tree.item_count(), visit);
    }
    const auto limit = [](double max_t) { return std::min(max_t * (1.0 + 1e-11), std::numeric_limits<double>::max()); };
    walk_nearest_first(
        tree.view(), limit(ray.max_t),
        [&](const BoundBlock& block, double most, double* entries) { return lanes_along(block, lanes, most, entries); },
        [&](std::uint32_t item) { return limit(visit(item)); });
}

void MovingTree::visit_near(const Aabb& bounds, double distance, Visitor visit) const {
    if (!(distance >= 0.0)) return;
    const ItemTree& tree = state_->tree;
    LaneBounds lanes;
    for (int i = 0; i < 3; ++i) {
        const double low = bounds.min[i] - state_->origin[i], high = bounds.max[i] - state_->origin[i],
                     slack = 1e-11 * (std::abs(bounds.min[i]) + std::abs(bounds.max[i]) + std::abs(state_->origin[i]));
        if (!(low - slack > -1e37) || !(high + slack < 1e37)) return visit_all(tree.item_count(), visit);
        lanes.low[i] = rounded_out(low - slack, -1.0f);
        lanes.high[i] = rounded_out(high + slack, 1.0f);
    }
    walk_nearest_first(
        tree.view(), square_of(distance),
        [&](const BoundBlock& block, float limit, float* squares) { return lanes_near(block, lanes, limit, squares); },
        [&](std::uint32_t item) { return square_of(visit(item)); });
}

}  // namespace crofton::collide
