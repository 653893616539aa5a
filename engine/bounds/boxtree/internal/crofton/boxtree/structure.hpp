// SPDX-License-Identifier: MIT
// Nodes and leaves of a BoxTree, and which item is in which slot: what queries read and what changes keep right.
// The leaves hold the items in slots: slot = 16 · leaf + lane, items in the lanes below the leaf's count.
#pragma once
#include <crofton/boxtree/change_marks.hpp>
#include <crofton/boxtree/items.hpp>
#include <crofton/boxtree/layout.hpp>
#include <crofton/core/growing_vector.hpp>
#include <crofton/core/stop_signal.hpp>
#include <crofton/measure/measure.hpp>
#include <span>

namespace crofton::boxtree {

struct Topology;

class Structure {
  public:
    // Builds a structure over placed items, all of them in `items`.
    Structure(Items& items, const measure::Criterion& criterion, Orientation orientation);
    Structure(const Structure&) = delete;
    Structure& operator=(const Structure&) = delete;

    [[nodiscard]] const Items& items() const { return items_; }
    [[nodiscard]] const measure::Criterion& criterion() const { return criterion_; }
    [[nodiscard]] Orientation orientation() const { return orientation_; }

    // The root is nodes()[0]; there always is one.
    [[nodiscard]] std::span<const Node> nodes() const { return nodes_.view(); }
    [[nodiscard]] std::span<const Axes> axes() const { return axes_; }  // the world's, then others
    [[nodiscard]] const Axes& axes_of(const Node& node) const { return axes_[node.axes]; }
    [[nodiscard]] std::span<const Leaf> leaves() const { return leaves_.view(); }
    [[nodiscard]] std::span<const ItemId> slot_items() const { return slot_items_.view(); }   // kNone in empty slots
    [[nodiscard]] std::span<const std::uint8_t> leaf_counts() const { return leaf_counts_; }  // leaves()[i].count
    [[nodiscard]] std::span<const LeafRange> leaf_ranges() const { return ranges_; }          // by NodeId
    [[nodiscard]] std::span<const RadiusRange> leaf_radii() const { return leaf_radii_; }
    [[nodiscard]] std::span<const NodeRadii> node_radii() const { return node_radii_; }
    [[nodiscard]] unsigned height() const { return height_; }  // nodes on the longest path from the root to a leaf
    [[nodiscard]] std::span<const std::uint32_t> item_slots() const { return item_slots_.view(); }  // kNone: in no leaf
    [[nodiscard]] std::uint32_t slot_of(ItemId item) const { return item_slots_[item]; }
    [[nodiscard]] bool contains(ItemId item) const { return item < item_slots_.size() && item_slots_[item] != kNone; }
    // An axis-aligned box around the bound of child `lane` of a node, rounded outward.
    [[nodiscard]] Aabb child_bounds(NodeId node, unsigned lane) const;
    // Around a node or leaf, as Node::child names it, along the axes of that index.
    [[nodiscard]] Aabb bounds_below(std::uint32_t child, std::uint32_t axes) const;
    // Returns the version of a complete structure; it does not change while one is built.
    [[nodiscard]] SlotsVersion slots_version() const { return slots_version_; }
    [[nodiscard]] const ChangeMarks& marks() const { return marks_; }

    // To make a structure: first room, then leaves, then nodes, children before parents. Different threads may make
    // different leaves, and nodes that are not above each other.
    void make_room(const Topology& topology, std::size_t more_items = 0);
    void make_room_for_leaves(LeafId end);
    void link_nodes(NodeId begin, NodeId end, const Topology& topology);
    // Gives leaf l its items. May prefetch the boxes of leaves before `end` alone: other threads may be making those
    // behind it. Where `current` is given, items that are in no leaf of it are left out.
    void fill_leaf(LeafId l, LeafId end, const Topology& topology, const Structure* current = nullptr);
    void bound_nodes(NodeId begin, NodeId end);
    void reset_marks() { marks_.reset(leaves_.size()); }

    // The same in steps. Each continues where the last one of its kind ended.
    void begin_steps(const Topology& topology);
    void add_items(ItemId end);
    void add_nodes(NodeId end, const Topology& topology);
    void add_leaves(LeafId end, const Topology& topology, const Structure& current);

    // To change items: their boxes and layers are written into items() first. These functions then bring them into the
    // leaves, and mark what the next refit must look at. A Placement puts items into leaves and takes them out.
    void reserve_items(std::size_t count) { item_slots_.reserve_pages(count); }
    void reserve_item(ItemId item);  // room for it, so that add_items(item + 1) cannot fail
    void update_box(ItemId item);
    void update_layers(ItemId item);
    // How many items from the first on are in leaves; then moves them all, to items() as well.
    [[nodiscard]] std::size_t find(std::span<const ItemId> items);
    void move_found(std::span<const ItemId> items, std::span<const Obb> boxes);

    // A structure that replaces another keeps its memory for work.
    void take_scratch(Structure& from) { std::swap(scratch_, from.scratch_); }

  private:
    friend class Placement;
    friend class Refit;
    friend struct TreeStorage;
    // Memory of moves and of refits, from call to call.
    struct Scratch {
        Vector<std::uint32_t> moved_slots;
        Vector<LeafId> leaves;
        Vector<NodeId> nodes, parents;
        Vector<std::uint64_t> node_bits;
    };

    void reserve(std::size_t nodes, std::size_t leaves);
    void init_node(NodeId n, const Topology& topology);
    void write_leaf_layers(LeafId l);
    void write_leaf_radii(LeafId l);
    void widen_leaf_radii(LeafId l, const Obb& box);
    void rewrite_leaf(LeafId l);
    [[nodiscard]] std::size_t write_leaves(std::span<const LeafId> leaves);
    void settle();
    void write_item(ItemId item);
    void refresh_node(NodeId n);
    void refresh_bounds(NodeId n);
    void copy_contents(NodeId n, unsigned lane);
    static void join_layers(Node& node);
    void refresh_contents(NodeId n, unsigned lane);
    [[nodiscard]] std::uint32_t items_without_gaps(NodeId n) const;

    Items& items_;
    measure::Criterion criterion_;
    Orientation orientation_;
    Vector<Axes> axes_ = Vector<Axes>(1);
    GrowingVector<Node> nodes_;
    Vector<LeafRange> ranges_;
    Vector<NodeRadii> node_radii_;
    GrowingVector<Leaf> leaves_;
    Vector<std::uint8_t> leaf_counts_;
    Vector<RadiusRange> leaf_radii_;
    GrowingVector<ItemId> slot_items_;
    GrowingVector<std::uint32_t> item_slots_;
    SlotsVersion slots_version_;
    unsigned height_ = 1;
    std::size_t next_free_leaf_ = 0;  // where a Placement looks on for an empty leaf
    ChangeMarks marks_;
    // Whether layers or radii have changed since the last refit; otherwise it looks at bounds alone.
    bool contents_changed_ = false;
    Scratch scratch_;
};

// Checks every invariant of a structure. Errors name the node, leaf or item.
[[nodiscard]] Result<void> validate(const Structure& structure, Trust trust, detail::StopSignal* stop = nullptr);

}  // namespace crofton::boxtree
