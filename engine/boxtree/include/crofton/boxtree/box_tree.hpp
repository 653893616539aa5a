// SPDX-License-Identifier: MIT
// A dynamic hierarchy of oriented boxes over items, for views and for collisions alike.
#pragma once
#include <crofton/boxtree/layout.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/measure/criterion.hpp>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace crofton::boxtree {

class Builder;
struct Topology;

struct BuildOptions {
    measure::Criterion criterion = measure::minimal_perimeter();
    // Items that will move nearly every frame, if known. In a tree of more than 32,768 items they share leaves with
    // each other, so that frames touch few leaves besides theirs. rebuild_step() finds such items by itself.
    std::span<const ItemId> moving = {};
    // Items that are detached from the start: see BoxTree::detach.
    std::span<const ItemId> detached = {};
};

// A step of a rebuild in the background, counted where the work is done.
struct RebuildStep {
    std::size_t items_added = 0, items_synced = 0;  // for the new tree; into it, as they have changed since
    std::size_t slots_cleared = 0, leaves_filled = 0, nodes_linked = 0, nodes_bounded = 0;
    std::size_t divisions = 0;  // steps of dividing items among leaves and nodes, each of the budget's size
};

// What deserialise() may take on trust. `contents`: the bytes are what serialise() wrote, as a checksum has shown; then
// only the links are checked, so that nothing leads out of the arrays, and a million items load in a tenth of the time.
enum class Trust : std::uint8_t { nothing, contents };

// Every node's bound contains (exactly) all boxes of the items below it. Item i's box is boxes()[i].
// The leaves hold the items in slots: slot = 16 · leaf + lane, items in the lanes below the leaf's count.
// Const functions may run on any number of threads at once; the others need the tree for themselves.
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
    ~BoxTree();
    BoxTree(BoxTree&&) noexcept;
    BoxTree& operator=(BoxTree&&) noexcept;

    // Changes. Errors leave the tree as it was: a box that fails validate(Obb), an item that is not in the tree (item =
    // its id), 2^30 items. After moves and removals the bounds are right again, and tight, after refit(); insert keeps
    // them right at once.
    [[nodiscard]] Result<void> move(ItemId item, const Obb& box);
    [[nodiscard]] Result<void> move(std::span<const ItemId> items, std::span<const Obb> boxes);  // all or none
    [[nodiscard]] Result<ItemId> insert(const Obb& box, std::uint32_t layer_mask = ~std::uint32_t{0});
    [[nodiscard]] Result<void> remove(ItemId item);  // its id is given to a later insert
    [[nodiscard]] Result<void> set_layer_mask(ItemId item, std::uint32_t layer_mask);
    void refit();

    // For what moves in every frame, which cull::MovingBoxes keeps beside the tree: a detached item is in no leaf, and
    // its id and layers stay its own until attach() puts it back or remove() gives the id away. Like remove and insert
    // otherwise.
    [[nodiscard]] Result<void> detach(ItemId item);
    // A new item that is in no leaf yet, as if inserted and detached. Errors: 2^30 items.
    [[nodiscard]] Result<ItemId> insert_detached(std::uint32_t layer_mask = ~std::uint32_t{0});
    [[nodiscard]] Result<void> attach(ItemId item, const Obb& box);
    [[nodiscard]] bool is_detached(ItemId item) const {
        return item / 64 < detached_bits_.size() && (detached_bits_[item / 64] >> item % 64 & 1) != 0;
    }
    // Bits that the layer masks of all detached items have, not necessarily every one.
    [[nodiscard]] std::uint32_t detached_layers() const { return detached_layers_; }

    // Rebuilds in the background, about `budget` items' worth of work a call, and while a rebuild is being brought up
    // to date twice as many items' more as have changed since the call before (a build is worth about 10 per item).
    // Call it once a frame where items move for long. True when a rebuild has just been completed. Items that moved
    // before both of the last two refits are taken for such as move all the time (see BuildOptions). Needs refit()
    // before and leaves nothing to refit.
    bool rebuild_step(std::size_t budget);
    // What the last call of rebuild_step() has handled, whatever it was worth.
    [[nodiscard]] const RebuildStep& last_rebuild_step() const { return last_step_; }

    // Checks every invariant: links, counts, slots, bounds. Errors name the node, leaf or item.
    [[nodiscard]] Result<void> validate() const;

    // A byte string that deserialise() turns into an equal tree, on machines of the same byte order. deserialise trusts
    // nothing: errors on damage of any kind.
    [[nodiscard]] Vector<std::byte> serialise() const;
    [[nodiscard]] static Result<BoxTree> deserialise(std::span<const std::byte> bytes, Trust trust = Trust::nothing);

    // By ItemId. Ids are below boxes().size(), removed ones included; item_count() is how many the leaves hold.
    [[nodiscard]] std::span<const Obb> boxes() const { return boxes_; }
    [[nodiscard]] std::span<const std::uint32_t> layer_masks() const { return layer_masks_; }
    [[nodiscard]] std::size_t item_count() const { return boxes_.size() - free_items_.size() - detached_count_; }
    [[nodiscard]] std::uint32_t slot_of(ItemId item) const {
        return structure_.item_slots[item];
    }  // kNone: removed or detached

    // The structure itself, root = nodes()[0]; there is always a root.
    [[nodiscard]] std::span<const Node> nodes() const { return structure_.nodes; }
    [[nodiscard]] std::span<const Leaf> leaves() const { return structure_.leaves; }
    [[nodiscard]] std::span<const ItemId> slot_items() const { return structure_.slot_items; }  // kNone in empty slots
    [[nodiscard]] std::span<const std::uint8_t> leaf_counts() const {
        return structure_.leaf_counts;
    }                                                                                           // leaves()[i].count
    [[nodiscard]] std::span<const LeafRange> leaf_ranges() const { return structure_.ranges; }  // by NodeId
    [[nodiscard]] unsigned height() const {
        return structure_.height;
    }  // nodes on the longest path from the root to a leaf

    // The bound of child `lane` of a node, as the exact box that the stored floats stand for, rounded outward.
    [[nodiscard]] Aabb child_bounds(NodeId node, unsigned lane) const;

  private:
    friend struct TreeStorage;
    struct Structure {
        Vector<Node> nodes;
        Vector<LeafRange> ranges;
        Vector<Leaf> leaves;
        Vector<std::uint8_t> leaf_counts;
        Vector<ItemId> slot_items;
        Vector<std::uint32_t> item_slots;
        // By leaf, one bit a lane: what has changed since the last refit, and what had before it and the one before.
        Vector<std::uint16_t> dirty_lanes, moved_last_refit, moved_two_refits_ago;
        unsigned height = 1;
    };
    struct Rebuild;
    // Where no more of a leaf's boxes have changed, move() writes each into its lane; where more have, refit() writes
    // them all.
    [[nodiscard]] static constexpr bool at_most_three_bits(unsigned lanes) {
        for (int few = 3; few > 0; --few) lanes &= lanes - 1;
        return lanes == 0;
    }
    static constexpr std::size_t kRefitBatch = 256;  // leaves that stay in the cache from their boxes to their bounds

    BoxTree();
    [[nodiscard]] Result<void> copy_and_validate(std::span<const Obb> boxes, Aabb& scene);
    void build_subtrees(Builder& builder, Executor& executor);
    void finish_nodes(NodeId begin, NodeId end, const Topology& topology);
    void start(Structure& structure, const Topology& topology) const;
    void init_node(Structure& structure, NodeId node, const Topology& topology) const;
    static void clear_marks(Structure& structure);
    void fill_leaf(Structure& structure, LeafId leaf, LeafId end, const Topology& topology) const;
    void rewrite_leaf(Structure& structure, LeafId leaf) const;
    void write_leaf_layers(Structure& structure, LeafId leaf) const;
    void write_item(Structure& structure, ItemId item) const;
    void prefetch_item(ItemId item) const;
    void write_dirty_leaves(Structure& structure, std::span<const LeafId> leaves) const;
    void refresh_node(Structure& structure, NodeId node) const;
    void finish_node(Structure& structure, NodeId node) const;
    [[nodiscard]] static std::uint32_t items_without_gaps(const Structure& structure, NodeId node);
    void invalidate_item_count(NodeId node);
    void refresh_layers(Structure& structure, NodeId node, unsigned lane) const;
    void refresh_path(NodeId node);
    void refit_leaves();
    void list_dirty_leaves();
    void clear_dirty_bits();
    void refit_node(NodeId node);
    void set_child(NodeId node, unsigned lane, const Aabb& bounds, Vector<NodeId>& dirty);
    void mark(std::uint32_t slot);
    void mark_moved();
    [[nodiscard]] bool has_few_changes(LeafId leaf) const;
    void mark_changed(ItemId item);
    [[nodiscard]] Result<ItemId> new_item(const Obb& box, std::uint32_t layer_mask);
    void place(ItemId item);
    void vacate(ItemId item);
    [[nodiscard]] LeafId best_leaf(const Aabb& bounds) const;
    LeafId add_leaf();
    void split_leaf(LeafId leaf);
    void add_child(NodeId parent, std::uint32_t child);
    void link(NodeId parent, unsigned lane, std::uint32_t child);
    NodeId split_node(NodeId node);
    std::size_t run_stage(Rebuild& work, std::size_t budget);
    std::size_t add_items(Rebuild& work, std::size_t budget);
    std::size_t fill_leaves(Rebuild& work, std::size_t budget);
    std::size_t apply_changes(Rebuild& work, std::size_t budget);
    void sync_item(ItemId item, bool present);
    void set_detached(ItemId item, bool detached);
    void find_detached();
    [[nodiscard]] Result<void> validate(Trust trust) const;
    [[nodiscard]] Result<void> validate_leaves(Trust trust) const;
    [[nodiscard]] bool is_present(ItemId item) const {
        return item < boxes_.size() && structure_.item_slots[item] != kNone;
    }
    [[nodiscard]] Result<void> check_item(ItemId item) const;
    [[nodiscard]] Result<void> find_moved(std::span<const ItemId> items, std::span<const Obb> boxes);

    measure::Criterion criterion_;
    Vector<Obb> boxes_;
    Vector<std::uint32_t> layer_masks_;
    Vector<ItemId> free_items_;
    Vector<std::uint64_t> detached_bits_;  // one bit an item, up to the last that was ever detached
    std::size_t detached_count_ = 0;
    std::uint32_t detached_layers_ = ~std::uint32_t{0};
    Structure structure_;
    Vector<std::uint32_t> moved_slots_;
    Vector<LeafId> dirty_list_;
    Vector<NodeId> dirty_nodes_, dirty_parents_;
    Vector<std::uint64_t> dirty_node_bits_;
    bool layers_changed_ = false;  // since the last refit: then layers are looked at again, otherwise only bounds
    std::unique_ptr<Rebuild> rebuild_;
    RebuildStep last_step_;
};

}  // namespace crofton::boxtree
