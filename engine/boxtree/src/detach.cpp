// SPDX-License-Identifier: MIT
// Items that leave the leaves and keep their ids.
#include <crofton/boxtree/box_tree.hpp>

namespace crofton::boxtree {

Result<void> BoxTree::detach(ItemId item) {
    if (auto known = check_item(item); !known) return known;
    vacate(item);
    set_detached(item, true);
    mark_changed(item);
    return {};
}

Result<ItemId> BoxTree::insert_detached(std::uint32_t layer_mask) {
    auto item = new_item({}, layer_mask);
    if (item) set_detached(*item, true);
    return item;
}

Result<void> BoxTree::attach(ItemId item, const Obb& box) {
    if (!is_detached(item))
        return fail(ErrorCode::out_of_range, item, "box tree: only what has been detached can attach");
    if (auto valid = crofton::validate(box, item); !valid) return valid;
    set_detached(item, false);
    boxes_[item] = box;
    mark_changed(item, true);
    place(item);
    return {};
}

void BoxTree::set_detached(ItemId item, bool detached) {
    if (detached_bits_.size() <= item / 64) detached_bits_.resize(item / 64 + 1, 0);
    detached_bits_[item / 64] ^= std::uint64_t{1} << item % 64;
    detached_count_ += detached ? 1 : std::size_t(-1);
    if (detached) detached_layers_ &= layer_masks_[item];
    if (detached_count_ == 0) detached_layers_ = ~std::uint32_t{0};
}

// In a tree that has been read: what is in no leaf, and whose id is not free.
void BoxTree::find_detached() {
    Vector<std::uint64_t> known((boxes_.size() + 63) / 64, 0);
    const auto mark = [&](ItemId item) { known[item / 64] |= std::uint64_t{1} << item % 64; };
    for (const ItemId item : free_items_)
        if (item < boxes_.size()) mark(item);
    for (ItemId item = 0; item < boxes_.size(); ++item)
        if (structure_.item_slots[item] == kNone && !(known[item / 64] >> item % 64 & 1)) set_detached(item, true);
}

}  // namespace crofton::boxtree
