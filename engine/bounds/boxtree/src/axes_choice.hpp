// SPDX-License-Identifier: MIT
// Along which axes the items below a node are divided, and the bounds of its children lie.
//
// By the paper's criterion a view that looks at a node looks at its children with chances in proportion to their
// perimeters (mean widths). So Σ perimeter(child) is what a visit of the node costs below, in visits times the node's
// perimeter. Turning the view's planes costs kTurnCost visits of a child more.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <span>

#include "partition.hpp"

namespace crofton::boxtree {

// In visits of a child; measured (docs/notes/boxtree.md).
inline constexpr double kTurnCost = 0.35;

// Returns a box as the builder sees it: its bound along `axes`, around `middle`.
[[nodiscard]] BuildItem build_item(ItemId id, const Obb& box, const glm::dvec3& middle, const Axes& axes);

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

}  // namespace crofton::boxtree
