// A dynamic hierarchy of oriented boxes over items, for views and for collisions alike.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/obb.hpp>
#include <crofton/measure/criterion.hpp>
#include <crofton/tree/layout.hpp>
#include <cstdint>
#include <span>

namespace crofton::tree {

struct BuildOptions {
    measure::Criterion criterion = measure::minimal_perimeter();
};

// Every node's bound contains (exactly) all boxes of the items below it. Item i's box is boxes()[i].
// The leaves hold the items in slots: slot = 16 · leaf + lane, items in the lanes below the leaf's count.
class BoxTree {
  public:
    // Item i is visible in the layers layer_masks[i]; an empty span means all layers for every item.
    // Errors: a box that fails validate(Obb), named by its index; more than 2^30 boxes; a criterion that fails
    // validate; layer_masks neither empty nor as many as boxes. No boxes at all is fine.
    [[nodiscard]] static Result<BoxTree> build(std::span<const Obb> boxes, const BuildOptions& options = {},
                                               Executor& executor = serial_executor());
    [[nodiscard]] static Result<BoxTree> build(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks,
                                               const BuildOptions& options = {},
                                               Executor& executor = serial_executor());

    // By ItemId. Ids are below boxes().size(), removed ones included.
    [[nodiscard]] std::span<const Obb> boxes() const { return boxes_; }
    [[nodiscard]] std::size_t item_count() const { return item_count_; }

    // The structure itself, root = nodes()[0]; there is always a root.
    [[nodiscard]] std::span<const Node> nodes() const { return nodes_; }
    [[nodiscard]] std::span<const Leaf> leaves() const { return leaves_; }
    [[nodiscard]] std::span<const ItemId> slot_items() const { return slot_items_; }      // kNone in empty slots
    [[nodiscard]] std::uint32_t slot_of(ItemId item) const { return item_slots_[item]; }  // kNone once removed
    [[nodiscard]] std::span<const std::uint8_t> leaf_counts() const {
        return leaf_counts_;
    }                                                                                 // leaves()[i].count, densely
    [[nodiscard]] std::span<const LeafRange> leaf_ranges() const { return ranges_; }  // by NodeId
    [[nodiscard]] unsigned height() const { return height_; }  // nodes on the longest path from the root to a leaf

    // The bound of child `lane` of a node, as the exact box that the stored floats stand for, rounded outward.
    [[nodiscard]] Aabb child_bounds(NodeId node, unsigned lane) const;

  private:
    BoxTree() = default;
    void rebuild(Executor& executor);
    [[nodiscard]] Aabb own_bounds(std::uint32_t child) const;
    void update_layers(NodeId node, unsigned lane);

    measure::Criterion criterion_;
    Vector<Obb> boxes_;
    Vector<std::uint32_t> layer_masks_;
    Vector<std::uint32_t> item_slots_;
    Vector<Node> nodes_;
    Vector<LeafRange> ranges_;
    Vector<Leaf> leaves_;
    Vector<std::uint8_t> leaf_counts_;
    Vector<ItemId> slot_items_;
    std::size_t item_count_ = 0;
    unsigned height_ = 1;
};

}  // namespace crofton::tree
