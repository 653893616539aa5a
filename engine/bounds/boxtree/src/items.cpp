// SPDX-License-Identifier: MIT
#include <crofton/boxtree/items.hpp>

#include <algorithm>
#include <crofton/boxtree/valid_boxes.hpp>

namespace crofton::boxtree {
namespace {

constexpr std::size_t kGrain = 1024;

}  // namespace

// Boxes are copied right after their check, while they are in the cache.
Result<void> Items::assign(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks, Aabb& centers,
                           std::size_t room) {
    boxes_.reserve(boxes.size() + room);
    layer_masks_.reserve(boxes.size() + room);
    for (std::size_t begin = 0; begin < boxes.size(); begin += kGrain) {
        const std::span<const Obb> some = boxes.subspan(begin, std::min(kGrain, boxes.size() - begin));
        for (std::size_t i = count_certainly_valid(some.data(), some.size()); i < some.size(); ++i)
            if (auto valid = crofton::validate(some[i], begin + i); !valid) return valid;
        for (const Obb& box : some) centers.include(box.center);
        boxes_.append(some);
    }
    layer_masks_.append(layer_masks);
    layer_masks_.resize(boxes.size(), ~std::uint32_t{0});
    return {};
}

Result<ItemId> Items::add(const Obb& box, std::uint32_t layer_mask) {
    const ItemId item = next_id();
    if (!free_ids_.empty()) {
        free_ids_.pop_back();
        boxes_.set(item, box);
        layer_masks_.set(item, layer_mask);
        return item;
    }
    if (item >= kMaxItems) return fail(ErrorCode::out_of_range, item, "box tree: more than 2^30 boxes");
    boxes_.make_room(1);
    layer_masks_.make_room(1);
    boxes_.append(box);
    layer_masks_.append(layer_mask);
    return item;
}

void Items::set_layers(ItemId item, std::uint32_t layer_mask) {
    layer_masks_.set(item, layer_mask);
    if (is_detached(item)) detached_layers_ &= layer_mask;
}

void Items::set_detached(ItemId item, bool detached) {
    if (detached_bits_.size() <= item / 64) detached_bits_.resize(item / 64 + 1, 0);
    detached_bits_[item / 64] ^= std::uint64_t{1} << item % 64;
    detached_count_ += detached ? 1 : std::size_t(-1);
    if (detached) detached_layers_ &= layer_masks_[item];
    if (detached_count_ == 0) detached_layers_ = ~std::uint32_t{0};
}

}  // namespace crofton::boxtree
