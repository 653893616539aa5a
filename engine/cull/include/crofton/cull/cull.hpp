// SPDX-License-Identifier: MIT
// Which items does a view see? From a list of boxes or from a tree of them.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/cull/classify.hpp>
#include <crofton/cull/statistics.hpp>
#include <crofton/cull/visible_set.hpp>
#include <crofton/geometry/frustum.hpp>
#include <cstdint>
#include <span>

namespace crofton::cull {

using boxtree::ItemId;

// Sees the items whose layer mask shares a bit with its own.
struct View {
    Frustum frustum;
    std::uint32_t layer_mask = ~std::uint32_t{0};
};

inline constexpr std::size_t kMaxViews = 32;  // in one pass

// Tree order costs nothing and is the same on every run; items that a renderer lays out in the tree's order
// (BoxTree::slot_items) come out in long ascending runs.
enum class ResultOrder : std::uint8_t { ascending, tree };

struct CullOptions {
    CullMode mode = CullMode::exact;
    ResultOrder order = ResultOrder::ascending;
};

// Finds the items that `view` sees and whose box is not outside; `visible` is overwritten, and once it has grown to the
// largest answer nothing is allocated. Same answer, bit for bit, from tree and list, with any executor and instruction
// set.
void find_visible(const boxtree::BoxTree& tree, const View& view, VisibleSet& visible, const CullOptions& options = {},
                  Executor& executor = serial_executor());

// Item i is boxes[i] with layer mask layer_masks[i], or all layers if that span is empty. Boxes that are not finite are
// straddling: reported, never lost.
void find_visible(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks, const View& view,
                  VisibleSet& visible, const CullOptions& options = {}, Executor& executor = serial_executor());

}  // namespace crofton::cull
