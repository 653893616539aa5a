// SPDX-License-Identifier: MIT
// Boxes that move in every frame, kept in a list outside the tree.
#include <hwy/cache_control.h>
#include <algorithm>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/cull/bound_set.hpp>

#include "tree/query.hpp"

namespace crofton::cull {

Result<void> MovingBoxes::update(const boxtree::BoxTree& tree, std::span<const ItemId> items,
                                 std::span<const Obb> boxes, Executor& executor) {
    if (items.size() != boxes.size())
        return fail(ErrorCode::invalid_argument, kNoItem, "moving boxes: as many boxes as items are needed");
    const boxtree::Items& known = tree.structure().items();
    for (const ItemId item : items)
        if (!known.is_detached(item))
            return fail(ErrorCode::out_of_range, item, "moving boxes: the item has not been detached from the tree");
    unstage_all();
    shapes_.clear();
    const std::size_t valid = sets_[1 - now_].update(boxes, executor);
    if (valid < boxes.size()) return validate(boxes[valid], items[valid]);
    now_ = 1 - now_;
    items_ = items;
    boxes_ = boxes;
    return {};
}

void find_visible(const boxtree::BoxTree& resting, const MovingBoxes& moving, const View& view, VisibleSet& visible,
                  const CullOptions& options, Executor& executor) {
    Query(view, visible, options, &moving).run(resting, executor);
}

// Appends the visible moving items, those that straddle to a list of their own.
void Query::add_moving(const boxtree::BoxTree& tree, std::size_t& inside, std::size_t& straddling, Executor& executor) {
    VerdictBits& bits = visible_.moving_bits_;
    find_visible(moving_->set(), moving_->boxes(), view_, bits, options_.mode, executor);
    if (kCountStatistics) visible_.statistics_ += bits.statistics;
    if (visible_.listed_.size() < moving_->size() + boxtree::kWidth)
        visible_.listed_.resize(moving_->size() + boxtree::kWidth);
    for (std::size_t w = 0; w < bits.visible.size(); ++w) bits.visible[w] &= ~bits.inside[w];
    append_moving(tree, bits.inside, visible_.ids_.data(), inside);
    append_moving(tree, bits.visible, visible_.straddling_.data(), straddling);
}

// Appends the items of the set bits that are in one of the view's layers.
void Query::append_moving(const boxtree::BoxTree& tree, std::span<const std::uint64_t> bits, ItemId* to,
                          std::size_t& count) {
    const boxtree::Items& known = tree.structure().items();
    std::uint32_t* listed = visible_.listed_.data();
    std::size_t found = list_bits(bits, visible_.listed_);
    const bool masks = options_.mask_moving && !options_.candidate_mask.empty();
    if (options_.limits || masks) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < found; ++i) {
            const std::uint32_t k = listed[i];
            const ItemId item = moving_->items()[k];
            listed[kept] = k;
            kept += (!masks || is_candidate(options_.candidate_mask, item)) &&
                    (!options_.limits || is_wanted(moving_->boxes()[k], item, known.layer_masks()[item]));
        }
        found = kept;
    }
    for (std::size_t i = 0; i < found; ++i) listed[i] = moving_->items()[listed[i]];
    if (known.detached_layers() & view_.layer_mask) {
        std::copy_n(listed, found, to + count);
        count += found;
        return;
    }
    // Layers lie anywhere, so they are prefetched. An item in none of the view's is overwritten by the next.
    constexpr std::size_t kAhead = 24;
    for (std::size_t i = 0; i < found; ++i) {
        hwy::Prefetch(&known.layer_masks()[listed[std::min(i + kAhead, found - 1)]]);
        to[count] = listed[i];
        count += (known.layer_masks()[listed[i]] & view_.layer_mask) != 0;
    }
}

}  // namespace crofton::cull
