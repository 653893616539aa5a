// Items that leave the leaves and keep their ids.
#include <crofton/boxtree/box_tree.hpp>

namespace crofton::boxtree {

Result<void> BoxTree::lift(ItemId item) {
    if (auto known = check_item(item); !known) return known;
    vacate(item);
    set_lifted(item, true);
    note_change(item);
    return {};
}

Result<ItemId> BoxTree::insert_lifted(std::uint32_t layer_mask) {
    auto item = new_item({}, layer_mask);
    if (item) set_lifted(*item, true);
    return item;
}

Result<void> BoxTree::settle(ItemId item, const Obb& box) {
    if (!is_lifted(item)) return fail(ErrorCode::out_of_range, item, "box tree: only what has been lifted can settle");
    if (auto valid = crofton::validate(box, item); !valid) return valid;
    set_lifted(item, false);
    boxes_[item] = box;
    note_change(item);
    place(item);
    return {};
}

void BoxTree::set_lifted(ItemId item, bool lifted) {
    if (lifted_bits_.size() <= item / 64) lifted_bits_.resize(item / 64 + 1, 0);
    lifted_bits_[item / 64] ^= std::uint64_t{1} << item % 64;
    lifted_count_ += lifted ? 1 : std::size_t(-1);
    if (lifted) lifted_layers_ &= layer_masks_[item];
    if (lifted_count_ == 0) lifted_layers_ = ~std::uint32_t{0};
}

// In a tree that has been read: what is in no leaf, and whose id is not free.
void BoxTree::find_lifted() {
    Vector<std::uint64_t> known((boxes_.size() + 63) / 64, 0);
    const auto mark = [&](ItemId item) { known[item / 64] |= std::uint64_t{1} << item % 64; };
    for (const ItemId item : free_items_)
        if (item < boxes_.size()) mark(item);
    for (ItemId item = 0; item < boxes_.size(); ++item)
        if (now_.item_slots[item] == kNone && !(known[item / 64] >> item % 64 & 1)) set_lifted(item, true);
}

}  // namespace crofton::boxtree
