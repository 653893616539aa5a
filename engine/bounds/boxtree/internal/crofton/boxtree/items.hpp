// SPDX-License-Identifier: MIT
// The items of a BoxTree, independent of their places: boxes, layers, free ids, detached items.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/error.hpp>
#include <crofton/core/growing_vector.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <cstdint>
#include <span>

namespace crofton::boxtree {

inline constexpr std::size_t kMaxItems = std::size_t{1} << 30;

// Makes room for more elements: an eighth more where there is none left. So a tree that is loaded and then changes does
// not double its memory.
template <class T>
void make_room_for(Vector<T>& items, std::size_t more) {
    if (items.size() + more > items.capacity()) items.reserve(items.size() + items.size() / 8 + 16 * more);
}

// Where a tree is built in steps, more items come meanwhile and afterwards.
[[nodiscard]] constexpr std::size_t with_room(std::size_t size) {
    return size + size / 16 + 16;
}

// The items of a tree, by id.
class Items {
  public:
    // Copies the boxes and widens `centers` to all their centres. Errors: a box that fails validate(Obb), by its index.
    // Takes memory for `room` more.
    [[nodiscard]] Result<void> assign(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks,
                                      Aabb& centers, std::size_t room = 0);

    void reserve(std::size_t count) {
        boxes_.reserve_pages(count);
        layer_masks_.reserve_pages(count);
    }
    [[nodiscard]] std::size_t capacity() const { return boxes_.capacity(); }

    [[nodiscard]] std::span<const Obb> boxes() const { return boxes_.view(); }
    [[nodiscard]] std::span<const std::uint32_t> layer_masks() const { return layer_masks_.view(); }
    [[nodiscard]] std::span<const ItemId> free_ids() const { return free_ids_; }
    [[nodiscard]] std::size_t size() const { return boxes_.size(); }  // ids given so far, free ones included
    [[nodiscard]] std::size_t count_in_leaves() const { return boxes_.size() - free_ids_.size() - detached_count_; }
    [[nodiscard]] bool is_detached(ItemId item) const {
        return item / 64 < detached_bits_.size() && (detached_bits_[item / 64] >> item % 64 & 1) != 0;
    }
    // Bits that every detached item has in its layer mask. There may be more such bits.
    [[nodiscard]] std::uint32_t detached_layers() const { return detached_layers_; }

    // The id of the next item: one that is free, if there is one.
    [[nodiscard]] ItemId next_id() const {
        return free_ids_.empty() ? static_cast<ItemId>(boxes_.size()) : free_ids_.back();
    }
    [[nodiscard]] Result<ItemId> add(const Obb& box, std::uint32_t layer_mask);  // errors: 2^30 items
    void free(ItemId item) { free_ids_.push_back(item); }
    void set_box(ItemId item, const Obb& box) { boxes_.set(item, box); }
    void set_layers(ItemId item, std::uint32_t layer_mask);
    void set_detached(ItemId item, bool detached);
    // Goes on copying arrays that grow.
    void settle() {
        boxes_.settle();
        layer_masks_.settle();
    }

  private:
    friend struct TreeStorage;
    GrowingVector<Obb> boxes_;
    GrowingVector<std::uint32_t> layer_masks_;
    Vector<ItemId> free_ids_;
    Vector<std::uint64_t> detached_bits_;  // by id, up to the last that was ever detached
    std::size_t detached_count_ = 0;
    std::uint32_t detached_layers_ = ~std::uint32_t{0};
};

}  // namespace crofton::boxtree
