// SPDX-License-Identifier: MIT
// The state that a broadphase keeps between updates. broadphase.cpp processes all boxes, broadphase_movers.cpp those
// that moved, and broadphase_pairs.cpp makes the lists of pairs.
#pragma once
#include <crofton/collide/broadphase.hpp>
#include <crofton/core/sorted_edits.hpp>

#include "bound_blocks.hpp"
#include "item_tree.hpp"
#include "lazy_list.hpp"
#include "pair_list.hpp"
#include "pair_table.hpp"
#include "space_order.hpp"

namespace crofton::collide {

// What one thread finds.
struct BroadphaseWorker {
    Vector<std::uint32_t> first, second;
    SlotPairs pairs;
    Vector<std::uint32_t> absent;  // items in the tree whose box is invalid
    Vector<IdPair> candidates;
    Vector<std::uint8_t> hits;
    std::uint64_t bound_pairs = 0;
    BatchStatistics boxes;
};

struct Broadphase::State {
    BroadphaseOptions options;
    BroadphaseStatistics statistics;
    SpaceOrder order;
    glm::dvec3 origin{0.0};
    ItemTree tree;  // of all items with valid boxes
    Vector<BroadphaseWorker> workers;
    PairList list;
    Vector<std::uint8_t> hits;
    bool current = false;  // the pairs are those of the last boxes

    struct IsBefore {
        bool operator()(const IdPair& a, const IdPair& b) const { return a < b; }
    };
    LazySortedList<IdPair, IsBefore> pairs;
    Vector<IdPair> began, ended;
    bool all_are_tested = true;
    LazyList<IdPair> stayed, tested;
    LazyList<std::uint32_t> rejected;
    PairTable table;  // of the pairs, where update_moved() follows update_moved()
    bool table_is_current = false;
    Vector<IdPair> previous;

    // Of update_moved. Items that moved, came or went, and whether an item did.
    struct Partner {
        std::uint32_t item, entry;  // of the table
    };
    Vector<std::uint8_t> is_moved;
    Vector<std::uint32_t> movers;
    std::size_t gone = 0;  // of the movers, the last: items of the update before that are dropped
    // Pairs that the movers had, each once: movers[m] has those from partners_begin[m] on.
    Vector<Partner> partners;
    Vector<std::uint32_t> partners_begin;
    // Movers in the tree, with their places among `movers`, and the pairs that they have: those from found_begin[q] on.
    Vector<std::uint32_t> queries, query_movers;
    Vector<LaneBounds> query_bounds;
    Vector<IdPair> found;
    Vector<std::uint32_t> found_begin;
    Vector<std::uint32_t> now, came, left, ended_entries;

    // broadphase.cpp
    [[nodiscard]] Result<void> update(std::span<const Obb> boxes, std::span<const CollisionFilter> filters,
                                      Executor& executor, const PairTest* test);
    [[nodiscard]] Result<void> update_moved(std::span<const Obb> boxes, std::span<const std::uint32_t> moved,
                                            std::span<const CollisionFilter> filters, Executor& executor,
                                            const PairTest* test);
    [[nodiscard]] Result<void> drop_pairs();
    [[nodiscard]] static Result<void> check(std::span<const Obb> boxes, std::span<const CollisionFilter> filters);
    [[nodiscard]] Result<void> update_all(std::span<const Obb> boxes, std::span<const CollisionFilter> filters,
                                          Executor& executor, const PairTest* test);
    void release_scratch();
    void place_all(std::span<const Obb> boxes, Executor& executor);
    void sort(std::span<const Obb> boxes, Executor& executor);
    [[nodiscard]] bool grow(SlotPairs& slots, BroadphaseWorker& worker) const;
    void refit(std::span<const Obb> boxes, Executor& executor);
    void bound_leaf(std::span<const Obb> boxes, std::size_t leaf, BroadphaseWorker& worker);
    [[nodiscard]] bool collect(Executor& executor);
    void keep_pairs_that_meet(std::span<const Obb> boxes, std::span<const CollisionFilter> filters,
                              const PairTest* test, BroadphaseWorker& worker) const;
    void sort_pairs(std::size_t item_count, Vector<IdPair>& sorted);
    void test_some(std::span<const Obb> boxes, std::span<const IdPair> candidates, const PairTest* test,
                   std::span<std::uint8_t> verdicts, BatchStatistics& counted) const;
    void test_pairs(std::span<const Obb> boxes, std::span<const IdPair> candidates, Executor& executor,
                    const PairTest* test);

    // broadphase_movers.cpp
    [[nodiscard]] Result<void> update_few(std::span<const Obb> boxes, std::span<const std::uint32_t> moved,
                                          std::span<const CollisionFilter> filters, Executor& executor,
                                          const PairTest* test);
    void gather_movers(std::size_t item_count, std::span<const std::uint32_t> moved);
    void begin_table();
    void note_count(std::size_t item_count);
    void gather_partners();
    void place_movers(std::span<const Obb> boxes);
    [[nodiscard]] bool find_candidates(std::span<const CollisionFilter> filters);
    void compare_partners();
};

}  // namespace crofton::collide
