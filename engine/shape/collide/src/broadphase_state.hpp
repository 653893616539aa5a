// SPDX-License-Identifier: MIT
// What a broadphase keeps between updates. broadphase.cpp looks at all boxes, broadphase_movers.cpp at those that
// moved.
#pragma once
#include <crofton/collide/broadphase.hpp>
#include <limits>

#include "bound_blocks.hpp"
#include "pair_list.hpp"
#include "space_order.hpp"

namespace crofton::collide {

// The order is made anew once the leaves' bounds have grown by this factor; a sort costs about as much as one update.
inline constexpr double kWornOut = 1.2;

inline void clear_lane(BoundBlock& block, std::size_t lane) {
    constexpr float kLargest = std::numeric_limits<float>::max();
    for (int i = 0; i < 3; ++i) {
        block.low[i][lane] = kLargest;
        block.high[i][lane] = -kLargest;
    }
}

// The sum of the bounds' extents; 0 for an empty lane.
[[nodiscard]] inline double extent_of_lane(const BoundBlock& block, std::size_t lane) {
    double extent = 0.0;
    for (int i = 0; i < 3; ++i)
        if (block.low[i][lane] <= block.high[i][lane])
            extent += static_cast<double>(block.high[i][lane]) - static_cast<double>(block.low[i][lane]);
    return extent;
}

// What one thread finds.
struct BroadphaseWorker {
    Vector<std::uint32_t> first, second;
    SlotPairs pairs;
    Vector<std::uint32_t> rejected;
    BatchStatistics boxes;
};

struct Broadphase::State {
    BroadphaseOptions options;
    BroadphaseStatistics statistics;
    SpaceOrder order;
    glm::dvec3 origin{0.0};
    Vector<BoundBlock> levels[kMaxLevels];
    BoundTree tree{};
    double leaf_extent = 0.0, leaf_extent_when_sorted = 0.0;
    Vector<BroadphaseWorker> workers;
    PairList list;
    Vector<std::uint8_t> hits;
    Vector<IdPair> pairs, previous, began, stayed, ended;
    Vector<std::uint32_t> rejected;
    bool current = false;  // the pairs are those of the last boxes, and the order holds all their items

    // Of update_moved: by item, whether it moved; the items that did, their slots, and the pairs they had and have.
    Vector<std::uint8_t> is_moved;
    Vector<std::uint32_t> movers, mover_slots;
    Vector<IdPair> kept, lost, found, still;

    [[nodiscard]] Result<void> drop_pairs();
    [[nodiscard]] static Result<void> check(std::span<const Obb> boxes, std::span<const CollisionFilter> filters);
    [[nodiscard]] Result<void> update_all(std::span<const Obb> boxes, std::span<const CollisionFilter> filters,
                                          Executor& executor);
    [[nodiscard]] Result<void> update_few(std::span<const Obb> boxes, std::span<const CollisionFilter> filters,
                                          Executor& executor);
    void gather_movers(std::size_t item_count, std::span<const std::uint32_t> moved);
    void move_bounds(std::span<const Obb> boxes);
    [[nodiscard]] bool find_candidates(std::span<const CollisionFilter> filters);
    [[nodiscard]] bool replace_pairs();
    [[nodiscard]] bool grow(SlotPairs& slots, BroadphaseWorker& worker) const;
    void refit(std::span<const Obb> boxes, Executor& executor);
    void bound_leaf(std::span<const Obb> boxes, std::size_t leaf, BroadphaseWorker& worker);
    void build_levels();
    [[nodiscard]] bool collect(Executor& executor);
    void sort_pairs(std::size_t item_count, std::span<const CollisionFilter> filters);
    void keep_pairs_that_meet(std::span<const Obb> boxes, Vector<IdPair>& candidates, Executor& executor);
};

}  // namespace crofton::collide
