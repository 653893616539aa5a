// SPDX-License-Identifier: MIT
// Changes of boxes and layers of items that stay in their slots.
#include <hwy/cache_control.h>
#include <crofton/boxtree/structure.hpp>

#include "bounds.hpp"

namespace crofton::boxtree {
namespace {

// Scattered items miss the cache. So slots and boxes are prefetched this many items ahead, then leaves.
constexpr std::size_t kFarAhead = 32, kNearAhead = 12;

template <class T>
void prefetch_all(const T& value) {
    for (std::size_t at = 0; at < sizeof(T); at += 64) hwy::Prefetch(reinterpret_cast<const char*>(&value) + at);
}

}  // namespace

void Structure::reserve_item(ItemId item) {
    if (item >= item_slots_.size()) item_slots_.make_room(1);
}

void Structure::update_box(ItemId item) {
    const std::uint32_t slot = item_slots_[item];
    marks_.mark(slot);
    widen_leaf_radii(slot / kWidth, items_.boxes()[item]);
    if (marks_.has_few_changes(slot / kWidth)) write_item(item);
}

void Structure::update_layers(ItemId item) {
    const std::uint32_t slot = item_slots_[item];
    write_layers(leaves_.edit(slot / kWidth), slot % kWidth, items_.layer_masks()[item]);
    contents_changed_ = true;
    marks_.mark(slot);
}

std::size_t Structure::find(std::span<const ItemId> items) {
    const std::uint32_t* slots = item_slots_.data();
    Vector<std::uint32_t>& found = scratch_.moved_slots;
    found.resize(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (i + kFarAhead < items.size() && items[i + kFarAhead] < item_slots_.size())
            hwy::Prefetch(slots + items[i + kFarAhead]);
        if (!contains(items[i])) return i;
        found[i] = slots[items[i]];
    }
    return items.size();
}

void Structure::move_found(std::span<const ItemId> items, std::span<const Obb> boxes) {
    const std::span<const std::uint32_t> slots = scratch_.moved_slots;
    marks_.mark(slots);
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (i + kFarAhead < items.size()) prefetch_all(items_.boxes()[items[i + kFarAhead]]);
        if (i + kNearAhead < items.size() && marks_.has_few_changes(slots[i + kNearAhead] / kWidth))
            prefetch_all(leaves_[slots[i + kNearAhead] / kWidth]);
        const LeafId leaf = slots[i] / kWidth;
        if (items_.boxes()[items[i]].half_extents != boxes[i].half_extents) widen_leaf_radii(leaf, boxes[i]);
        items_.set_box(items[i], boxes[i]);
        if (marks_.has_few_changes(leaf) && !write_lane(leaves_.edit(leaf), slots[i] % kWidth, boxes[i]))
            rewrite_leaf(leaf);
    }
}

}  // namespace crofton::boxtree
