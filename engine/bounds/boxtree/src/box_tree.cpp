// SPDX-License-Identifier: MIT
// The tree as its users see it: items, the structure above them, and a rebuild under way, kept in step.
#include <crofton/boxtree/box_tree.hpp>

#include <algorithm>
#include <crofton/boxtree/items.hpp>
#include <crofton/boxtree/rebuilder.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/boxtree/valid_boxes.hpp>

#include "placement.hpp"
#include "refit.hpp"

namespace crofton::boxtree {

BoxTree::BoxTree(const measure::Criterion& criterion, Orientation orientation)
    : items_(Owner<Items>::make()),
      structure_(Owner<Structure>::make(*items_, criterion, orientation)),
      rebuilder_(Owner<Rebuilder>::make()) {}
BoxTree::~BoxTree() = default;
BoxTree::BoxTree(BoxTree&&) noexcept = default;
BoxTree& BoxTree::operator=(BoxTree&&) noexcept = default;

bool BoxTree::is_detached(ItemId item) const {
    return items_->is_detached(item);
}

bool BoxTree::contains(ItemId item) const {
    return structure_->contains(item);
}

std::size_t BoxTree::item_count() const {
    return items_->count_in_leaves();
}

std::span<const Obb> BoxTree::boxes() const {
    return items_->boxes();
}

std::span<const std::uint32_t> BoxTree::layer_masks() const {
    return items_->layer_masks();
}

Vector<ItemId> BoxTree::spatial_order() const {
    Vector<ItemId> order;
    order.reserve(item_count());
    for (const ItemId item : structure_->slot_items())
        if (item != kNone) order.push_back(item);
    return order;
}

Result<void> BoxTree::check_item(ItemId item) const {
    if (items_->is_detached(item))
        return fail(ErrorCode::out_of_range, item, "box tree: the item has been detached; attach it first");
    if (!contains(item)) return fail(ErrorCode::out_of_range, item, "box tree: no such item, or it has been removed");
    return {};
}

Result<void> BoxTree::reserve(std::size_t items) {
    if (items > kMaxItems) return fail(ErrorCode::out_of_range, kNoItem, "box tree: more than 2^30 items");
    items_->reserve(items);
    structure_->reserve_items(items);
    return {};
}

Result<void> BoxTree::move(ItemId item, const Obb& box) {
    return move(std::span(&item, 1), std::span(&box, 1));
}

Result<void> BoxTree::move(std::span<const ItemId> items, std::span<const Obb> boxes) {
    if (items.size() != boxes.size())
        return fail(ErrorCode::invalid_argument, kNoItem, "box tree: as many boxes as items are needed");
    if (const std::size_t found = structure_->find(items); found < items.size()) return check_item(items[found]);
    for (std::size_t i = 0; i < boxes.size();) {
        i += count_certainly_valid(&boxes[i], boxes.size() - i);
        for (const std::size_t end = std::min(boxes.size(), i + kWidth); i < end; ++i)
            if (auto valid = crofton::validate(boxes[i], items[i]); !valid) return valid;
    }
    structure_->move_found(items, boxes);
    rebuilder_->note_changes(items);
    return {};
}

Result<void> BoxTree::set_layer_mask(ItemId item, std::uint32_t layer_mask) {
    if (items_->is_detached(item)) {
        items_->set_layers(item, layer_mask);
        return {};
    }
    if (auto known = check_item(item); !known) return known;
    items_->set_layers(item, layer_mask);
    structure_->update_layers(item);
    rebuilder_->note_change(item);
    return {};
}

Result<void> BoxTree::remove(ItemId item) {
    if (items_->is_detached(item)) {
        items_->set_detached(item, false);
        items_->free(item);
        return {};
    }
    if (auto known = check_item(item); !known) return known;
    Placement(*structure_).vacate(item);
    items_->free(item);
    rebuilder_->note_change(item);
    return {};
}

Result<ItemId> BoxTree::new_item(const Obb& box, std::uint32_t layer_mask) {
    structure_->reserve_item(items_->next_id());
    auto item = items_->add(box, layer_mask);
    if (item) structure_->add_items(*item + 1);
    return item;
}

Result<ItemId> BoxTree::insert(const Obb& box, std::uint32_t layer_mask) {
    if (auto valid = crofton::validate(box, items_->next_id()); !valid) return valid.error();
    auto item = new_item(box, layer_mask);
    if (!item) return item;
    rebuilder_->note_change(*item, true);
    Placement(*structure_).place(*item);
    return item;
}

Result<void> BoxTree::detach(ItemId item) {
    if (auto known = check_item(item); !known) return known;
    Placement(*structure_).vacate(item);
    items_->set_detached(item, true);
    rebuilder_->note_change(item);
    return {};
}

Result<ItemId> BoxTree::insert_detached(std::uint32_t layer_mask) {
    auto item = new_item({}, layer_mask);
    if (item) items_->set_detached(*item, true);
    return item;
}

Result<void> BoxTree::attach(ItemId item, const Obb& box) {
    if (!items_->is_detached(item))
        return fail(ErrorCode::out_of_range, item, "box tree: attach needs a detached item");
    if (auto valid = crofton::validate(box, item); !valid) return valid;
    items_->set_detached(item, false);
    items_->set_box(item, box);
    rebuilder_->note_change(item, true);
    Placement(*structure_).place(item);
    return {};
}

void BoxTree::keep_box(ItemId item, const Obb& box) {
    CROFTON_ASSERT(item < items_->size() && !contains(item), "keep_box needs an item in no leaf");
    items_->set_box(item, box);
}

void BoxTree::refit() {
    Refit(*structure_).run();
    items_->settle();
}

bool BoxTree::rebuild_step(std::size_t budget) {
    Owner<Structure> next = rebuilder_->step(*structure_, *items_, budget);
    if (!next) return false;
    next->take_scratch(*structure_);
    structure_ = std::move(next);
    return true;
}

Result<void> BoxTree::validate(StopCallback should_stop, void* stop_user) const {
    detail::StopSignal stop(should_stop, stop_user);
    return boxtree::validate(*structure_, Trust::nothing, &stop);
}

}  // namespace crofton::boxtree
