// From boxes to the topology of a tree: which items share a leaf, which leaves a node; in steps, if need be.
#pragma once
#include <array>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/obb.hpp>
#include <crofton/measure/criterion.hpp>
#include <crofton/tree/layout.hpp>
#include <span>

#include "partition.hpp"

namespace crofton::tree {

struct Topology {
    struct NodeRecord {
        std::uint32_t child[kWidth];
        std::uint32_t count = 0;
        NodeId parent = kNone;
        std::uint32_t lane_in_parent = 0;
        LeafRange leaves;
    };
    struct LeafRecord {
        std::uint32_t first = 0, count = 0;  // into `order`
        NodeId parent = kNone;
        std::uint32_t lane_in_parent = 0;
    };
    Vector<NodeRecord> nodes;   // parents before children, [0] the root
    Vector<LeafRecord> leaves;  // in the order of a walk from the root
    Vector<ItemId> order;       // the items, leaf by leaf
    unsigned height = 1;
};

// Which items move so often that they are to share leaves with each other rather than with those at rest.
struct Movers {
    bool (*contain)(const void* context, ItemId item) = [](const void*, ItemId) { return false; };
    const void* context = nullptr;
};

// Small crowds are split from the top by the criterion. Large ones are first sorted along a space-filling curve into
// clusters of 4096, of items that move or of items at rest; the clusters are split from the top, and each cluster within
// itself: the same work per item whatever their number.
class Builder {
  public:
    // Coordinates are taken around `scene`'s middle. `items` is how many will be added.
    Builder(const Aabb& scene, std::size_t items, const measure::Criterion& criterion);

    void add(ItemId id, const Obb& box);

    // After the last add: works on, about `budget` items' worth; true when result() is ready. Same result for any
    // budgets.
    bool step(std::size_t budget, const Movers& movers, Executor& executor);
    [[nodiscard]] Topology& result() { return result_; }

  private:
    enum class Phase : std::uint8_t { keys, sort, crowding, gather, append, clusters, split, assemble, order, done };
    struct Task {
        Range range;  // of clusters or of items
        NodeId parent;
        std::uint32_t lane;
        unsigned depth;
        bool of_clusters;
    };
    struct Key {
        std::uint64_t code;
        std::uint32_t index;
    };

    std::size_t compute_keys(std::size_t budget);
    std::size_t sort_pass(std::size_t budget);
    std::size_t find_crowding(std::size_t budget);
    std::size_t gather_items(std::size_t budget, const Movers& movers);
    std::size_t append_moving(std::size_t budget);
    std::size_t make_clusters(std::size_t budget);
    [[nodiscard]] Range items_of_cluster(std::uint32_t cluster) const;
    std::size_t split_clusters(std::size_t budget, Executor& executor);
    void start_assembly();
    std::size_t assemble(std::size_t budget);
    void add_leaf(const Task& task);
    void number_leaves();
    std::size_t list_order(std::size_t budget);

    Cost cost_;
    glm::dvec3 middle_;
    float low_[3], inverse_size_[3], cell_;
    Vector<BuildItem> items_, sorted_, moving_;
    std::size_t resting_count_ = 0;  // the items that move follow these
    std::size_t equal_keys_ = 0;
    Vector<Key> keys_, keys_next_;
    std::array<std::uint32_t, 2048> histogram_{};
    unsigned pass_ = 0;
    bool counting_ = true;
    Vector<BuildItem> clusters_;
    Vector<Children> cluster_children_;
    Vector<Task> tasks_;
    std::size_t next_ = 0;
    Phase phase_ = Phase::keys;
    Topology result_;
};

}  // namespace crofton::tree
