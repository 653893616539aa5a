// SPDX-License-Identifier: MIT
// What moves in every frame: a list over the caller's own boxes, asked together with a tree of what rests.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <cstddef>
#include <span>

namespace crofton::cull {

// The ids are the tree's: an item is taken out of it when it begins to move (BoxTree::detach), and is put back when it
// comes to rest. The layers are the tree's too. 80 bytes an item beside the caller's boxes.
class MovingBoxes {
  public:
    // From now on these are the items that move, each once, and boxes[k] is that of items[k]. Both are the caller's and
    // are not copied: they must stay as they are until the next update. It reads each box once, whatever has changed.
    // Errors leave the list as it was: as many boxes as items are needed; an item that has not been detached; a box
    // that fails validate(Obb), named by its item. Where it was overwritten in place, put it right before the next
    // query.
    [[nodiscard]] Result<void> update(const boxtree::BoxTree& tree, std::span<const ItemId> items,
                                      std::span<const Obb> boxes, Executor& executor = serial_executor());

    [[nodiscard]] std::span<const ItemId> items() const { return items_; }
    [[nodiscard]] std::span<const Obb> boxes() const { return boxes_; }
    [[nodiscard]] std::size_t size() const { return items_.size(); }
    [[nodiscard]] const BoxSet& set() const { return sets_[now_]; }  // over boxes()

  private:
    std::span<const ItemId> items_;
    std::span<const Obb> boxes_;
    BoxSet sets_[2];  // an update is written into the one, and counts once all of it is known to be good
    unsigned now_ = 0;
};

// As find_visible() with the tree alone, in every respect: what rests and what moves in one answer. In
// ResultOrder::tree the items that move follow those that rest, inside and straddling apart. Requires the tree that
// `moving` was updated with.
void find_visible(const boxtree::BoxTree& resting, const MovingBoxes& moving, const View& view, VisibleSet& visible,
                  const CullOptions& options = {}, Executor& executor = serial_executor());

// Up to 32 views in one pass; the items that move come last.
void find_visible(const boxtree::BoxTree& resting, const MovingBoxes& moving, std::span<const View> views,
                  ManyVisible& visible, CullMode mode = CullMode::exact);

}  // namespace crofton::cull
