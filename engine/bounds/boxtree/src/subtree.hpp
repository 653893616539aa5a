// SPDX-License-Identifier: MIT
// The nodes and leaves below one node, from its items.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/layout.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <span>

#include "partition.hpp"

namespace crofton::boxtree {

// In visits of a child; measured (docs/notes/boxtree.md).
inline constexpr double kTurnCost = 0.35;

// Returns a box as the builder sees it: its bound along `axes`, around `middle`.
[[nodiscard]] BuildItem build_item(ItemId id, const Obb& box, const glm::dvec3& middle, const Axes& axes);

// Chooses along which axes the items below a node are divided, and the bounds of its children lie.
//
// By the paper's criterion a view that looks at a node looks at its children with chances in proportion to their
// perimeters (mean widths). So Σ perimeter(child) is what a visit of the node costs below, in visits times the node's
// perimeter. Turning the view's planes costs kTurnCost visits of a child more.
//
// Tries the axes that are at hand: the present ones, the world's, and those of some items. They are tried one at a
// time, since each takes a division of all items. Memory is kept from node to node.
class AxesChooser {
  public:
    [[nodiscard]] bool is_busy() const { return next_ > 0; }
    // For `indices` of `items`, whose coordinates lie along `now`.
    void begin(std::span<const BuildItem> items, std::span<const std::uint32_t> indices, const Axes& now);
    // Tries the next; true when all have been tried.
    [[nodiscard]] bool step(std::span<const Obb> boxes, const glm::dvec3& middle, const Cost& cost,
                            Orientation orientation);

    // Whether others than those that are do better; then items() are along axes() and in the order of `indices`, and
    // splitter() has them sorted.
    [[nodiscard]] bool has_found() const { return found_; }
    [[nodiscard]] const Axes& axes() const { return best_axes_; }
    [[nodiscard]] std::span<const BuildItem> items() const { return best_items_; }
    [[nodiscard]] std::span<const std::uint32_t> indices() const { return indices_; }
    [[nodiscard]] const Splitter& splitter() const { return splitter_; }

  private:
    static constexpr std::size_t kSamples = 3;  // of the items' axes, beside those that are and the world's
    void try_axes(const Axes& axes, const Cost& cost, Orientation orientation);

    std::size_t next_ = 0;
    Axes tried_[kSamples + 2];
    std::size_t tried_count_ = 0;
    double least_ = 0.0;
    bool found_ = false;
    Axes best_axes_;
    Splitter splitter_;
    Vector<BuildItem> items_, best_items_;
    Vector<std::uint32_t> indices_;
};

struct Topology {
    struct NodeRecord {
        std::uint32_t child[kWidth];
        std::uint32_t count = 0;
        NodeId parent = kNone;
        std::uint32_t lane_in_parent = 0;
        std::uint32_t axes = 0;  // of `axes`
        LeafRange leaves;
    };
    struct LeafRecord {
        std::uint32_t first = 0, count = 0;  // into `order`
        NodeId parent = kNone;
        std::uint32_t lane_in_parent = 0;
    };
    Vector<NodeRecord> nodes;   // parents before children, [0] the root
    Vector<LeafRecord> leaves;  // in the order of a walk from the root
    Vector<ItemId> order;       // the items; a leaf's lie next to each other
    // The world's, and those of node n at n + 1 where it has others than its parent; empty where none is turned.
    Vector<Axes> axes;
    unsigned height = 1;
    std::uint32_t node_leaves = kWidth;  // how many leaves a node above leaves gets: fewer leave room for others
};

// Returns a box as the builder sees it, around `middle`.
[[nodiscard]] BuildItem build_item(ItemId id, const Obb& box, const glm::dvec3& middle);

// A node and what is below it. How many nodes and leaves that takes depends on the number of items alone, so that
// places can be given away before anything is built.
struct Subtree {
    Range items;  // of Topology::order
    NodeId first_node = 0, parent = kNone;
    LeafId first_leaf = 0;
    std::uint32_t lane_in_parent = 0;
    std::uint32_t nodes = 0, leaves = 0;
    unsigned height = 1;

    Subtree(Range range, std::uint32_t node_leaves);  // sizes; the places are still to be set

    // A child of another node with so few items that it is a leaf itself.
    [[nodiscard]] bool is_leaf() const { return parent != kNone && items.size() <= kWidth; }
};

class SubtreeBuilder {
  public:
    // Items that order[items] names; their places in `order` change among them.
    void start(const Subtree& subtree, const glm::dvec3& middle);

    // Works on, about `budget` items' worth, which is lessened by what was spent; true when the subtree is complete.
    bool step(std::size_t& budget, const Cost& cost, Orientation orientation, std::span<const Obb> boxes,
              Topology& topology);

    // How often an item has been looked at.
    [[nodiscard]] std::size_t visits() const { return gathered_ + splitter_.visits(); }

  private:
    struct Task {
        Range range;  // of the items
        NodeId parent;
        std::uint32_t lane;
        std::uint32_t axes = 0;  // that its items lie along
    };
    bool step_on(std::size_t& work, const Cost& cost, Orientation orientation, std::span<const Obb> boxes,
                 Topology& topology);
    bool gather(std::size_t& work, std::span<const Obb> boxes, const Topology& topology);
    void begin_node(const Task& task, Topology& topology);
    void add_children(Topology& topology);
    void add_leaf(const Task& task, Topology& topology);
    [[nodiscard]] bool choose_axes(const Cost& cost, Orientation orientation, std::span<const Obb> boxes,
                                   Topology& topology);

    std::uint32_t first_item_ = 0, item_count_ = 0;
    NodeId next_node_ = 0, divided_ = kNone;  // the second: whose items are being divided
    LeafId next_leaf_ = 0;
    std::size_t gathered_ = 0;
    Vector<BuildItem> items_;
    Splitter splitter_;
    AxesChooser chooser_;
    glm::dvec3 middle_{0.0};
    Vector<Task> tasks_;
};

}  // namespace crofton::boxtree
