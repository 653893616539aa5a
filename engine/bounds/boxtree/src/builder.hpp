// SPDX-License-Identifier: MIT
// From boxes to the topology of a tree: which items share a leaf, which leaves a node; in steps, if need be.
#pragma once
#include <array>
#include <crofton/boxtree/layout.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/core/stop_signal.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/measure/measure.hpp>
#include <span>

#include "partition.hpp"
#include "subtree.hpp"

namespace crofton::boxtree {

// Marks items that move so often that they should share leaves with each other, not with resting ones.
struct Movers {
    bool (*contain)(const void* context, ItemId item) = [](const void*, ItemId) { return false; };
    const void* context = nullptr;
};

// Crowds of at most `small_crowd` items are split from the top: the best tree, at a cost that grows with n log n. A
// node above leaves gets `node_leaves` of them.
struct BuildGrain {
    std::size_t small_crowd = 32768;
    std::uint32_t node_leaves = kWidth;
};

// Makes the topology of a tree. Small crowds are split from the top by the criterion. Large ones are first sorted along
// a space-filling curve into clusters of sixteen such nodes, which all move or all rest. The clusters are split from
// the top, and each cluster within itself, a subtree for each. The work per item is the same whatever their number.
class Builder {
  public:
    // Coordinates are taken around `scene`'s middle. `items` is how many will be added.
    Builder(const Aabb& scene, std::size_t items, const measure::Criterion& criterion,
            Orientation orientation = Orientation::aligned, const BuildGrain& grain = {});

    // Notes where the item is.
    void add(ItemId id, const Obb& box);
    // All of add() and prepare() for items 0 … boxes.size() − 1, shared among threads; the same result.
    // Returns earlier once the signal is raised.
    void prepare_all(std::span<const Obb> boxes, const Movers& movers, detail::StopSignal& stop, Executor& executor);

    // After the last add, a step of about `budget` items' worth; true when result() is ready. Same result for any
    // budgets, if the boxes of the items that were added stay as they are; they may change, to the result's
    // disadvantage.
    bool step(std::size_t budget, std::span<const Obb> boxes, const Movers& movers);

    // The same in two parts, for threads: prepare() until it is true, then build() each of subtrees() once, in any
    // order.
    bool prepare(std::size_t budget, std::span<const Obb> boxes, const Movers& movers);
    [[nodiscard]] std::span<const Subtree> subtrees() const { return subtrees_; }
    void make_room_for_leaves() { result_.leaves.resize(leaf_count_); }  // before the first build()
    // Asks after each `budget` whether to stop; false if so.
    bool build(std::size_t subtree, SubtreeBuilder& with, std::span<const Obb> boxes, std::size_t budget,
               FunctionRef<bool()> wants_stop);

    [[nodiscard]] std::size_t visits() const { return subtree_builder_.visits(); }  // by step(), of items

    // Once the result is ready: gives back all memory but the result's.
    void release_scratch() { subtree_builder_ = {}; }

    // The nodes before the subtrees' first have no subtree.
    [[nodiscard]] const Topology& result() const { return result_; }

  private:
    // A key has four bits for the size, ten for the cell along each axis, and thirty for the item. Ten more bits along
    // each axis are computed from the item's box where they are needed.
    static constexpr unsigned kItemBits = 30, kDigitBits = 12, kPasses = 3, kFineBits = 10;
    static constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;

    enum class Phase : std::uint8_t { sort, crowding, gather, append, label, bound, place, gather_all, ready };

    // The nodes above the clusters, while they are made.
    struct Above {
        struct Task {
            Range range;  // of clusters
            NodeId parent;
            std::uint32_t lane;
            unsigned depth;
        };
        Splitter splitter;
        Vector<Task> tasks;
        NodeId divided = kNone;  // whose clusters are being divided
        unsigned depth = 0;      // of that
    };

    [[nodiscard]] static ItemId item_of(std::uint64_t key);
    [[nodiscard]] std::uint64_t key_of(ItemId id, const Obb& box) const;
    void sort_keys(Executor& executor);
    void label_items(Executor& executor);
    void bound_clusters(std::span<const Obb> boxes, Executor& executor);
    bool prepare_some(std::size_t& budget, std::span<const Obb> boxes, const Movers& movers);  // lessens the budget
    std::size_t prepare_on(std::size_t budget, std::span<const Obb> boxes, const Movers& movers);
    [[nodiscard]] std::array<std::uint32_t, 3> cell_of(const glm::dvec3& center) const;
    std::size_t sort_pass(std::size_t budget);
    std::size_t find_crowding(std::size_t budget, std::span<const Obb> boxes);
    void sort_crowd(std::span<std::uint64_t> keys, std::span<const Obb> boxes);
    std::size_t gather_items(std::size_t budget, std::span<const Obb> boxes, const Movers& movers);
    std::size_t append_moving(std::size_t budget);
    std::size_t gather_all(std::size_t budget);
    void start_clusters();
    std::size_t label_items(std::size_t budget);
    std::size_t bound_clusters(std::size_t budget, std::span<const Obb> boxes);
    std::size_t place_clusters(std::size_t budget);
    void place_all();
    void place_subtrees();

    Cost cost_;
    Orientation orientation_;
    std::size_t small_crowd_;
    glm::dvec3 middle_;
    double half_size_ = 0.0, cells_per_unit_ = 0.0;
    float cell_ = 0.0f;
    Vector<std::uint64_t> keys_, keys_next_;
    std::array<std::array<std::uint32_t, kDigits>, kPasses> histograms_{};
    unsigned pass_ = 0;
    std::size_t crowded_ = 0;  // items that share a cell with others, and no smaller cells help
    Vector<ItemId> moving_;
    std::size_t resting_count_ = 0;  // the items that move follow these
    Vector<Range> cluster_ranges_;
    Vector<std::uint32_t> cluster_of_;  // by item; kNone where there is none
    Vector<BuildItem> clusters_;
    Above above_;
    Vector<Subtree> subtrees_;
    LeafId leaf_count_ = 0;
    std::uint32_t labels_ = 0;  // the cluster of the item that is labelled next
    std::size_t next_ = 0;
    SubtreeBuilder subtree_builder_;
    bool building_ = false;
    Phase phase_ = Phase::sort;
    Topology result_;
};

}  // namespace crofton::boxtree
