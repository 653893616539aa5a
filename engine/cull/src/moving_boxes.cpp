#include <crofton/core/assert.hpp>
#include <crofton/cull/moving_boxes.hpp>

#include "query.hpp"

namespace crofton::cull {

Result<void> MovingBoxes::update(const tree::BoxTree& tree, std::span<const ItemId> items, std::span<const Obb> boxes,
                                 Executor& executor) {
    if (items.size() != boxes.size())
        return fail(ErrorCode::invalid_argument, kNoItem, "moving boxes: as many boxes as items are needed");
    for (const ItemId item : items)
        if (!tree.is_lifted(item))
            return fail(ErrorCode::out_of_range, item, "moving boxes: the item has not been lifted from the tree");
    const std::size_t valid = sets_[1 - now_].update(boxes, executor);
    if (valid < boxes.size()) return validate(boxes[valid], items[valid]);
    now_ = 1 - now_;
    items_ = items;
    boxes_ = boxes;
    return {};
}

void cull(const tree::BoxTree& resting, const MovingBoxes& moving, const View& view, VisibleSet& visible,
          const Options& options, Executor& executor) {
    Query(view, visible, options, &moving).run(resting, executor);
}

// Straddling ones go to `straddling`. What is in none of the view's layers is written, and overwritten by the next.
void Query::add_moving(const tree::BoxTree& tree, std::size_t& inside, std::size_t& straddling, Executor& executor) {
    VerdictBits& bits = visible_.moving_bits_;
    cull(moving_->set(), moving_->boxes(), view_, bits, options_.mode, executor);
    if (kCountStatistics) visible_.statistics_ += bits.statistics;
    if (visible_.listed_.size() < moving_->size() + tree::kWidth) visible_.listed_.resize(moving_->size() + tree::kWidth);
    const std::uint32_t* layers = tree.layer_masks().data();
    const ItemId* items = moving_->items().data();
    const auto append = [&](std::span<const std::uint64_t> of, ItemId* to, std::size_t& count) {
        const std::size_t listed = list_bits(of, visible_.listed_);
        for (std::size_t i = 0; i < listed; ++i) {
            const ItemId item = items[visible_.listed_[i]];
            to[count] = item;
            count += (layers[item] & view_.layer_mask) != 0;
        }
    };
    for (std::size_t w = 0; w < bits.visible.size(); ++w) bits.visible[w] &= ~bits.inside[w];
    append(bits.inside, visible_.ids_.data(), inside);
    append(bits.visible, visible_.straddling_.data(), straddling);
}

}  // namespace crofton::cull
