// SPDX-License-Identifier: MIT
// The list of moving objects: their boxes as of the last update, and a second array for the next one.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/geometry/same_bits.hpp>
#include <cstddef>
#include <cstdint>
#include <span>

namespace crofton::world {

using boxtree::ItemId;

// Items have entries 0, 1, … in all arrays. Times are counts of updates. `now` never falls.
class MovingList {
  public:
    [[nodiscard]] std::size_t size() const { return items_.size(); }
    [[nodiscard]] ItemId item(std::size_t entry) const { return items_[entry]; }
    [[nodiscard]] const Obb& box(std::size_t entry) const { return boxes_[entry]; }
    [[nodiscard]] std::uint32_t last_moved(std::size_t entry) const { return last_moved_[entry]; }
    [[nodiscard]] const cull::MovingBoxes& boxes() const { return moving_boxes_; }  // as of the last update()

    // Returns the entry: the last.
    std::uint32_t add(ItemId item, const Obb& box, std::uint32_t last_moved);
    // The last item takes the entry. Requires that nothing is staged.
    void remove(std::size_t entry);
    // At once. True if it is another box.
    bool set_box(std::size_t entry, const Obb& box, std::uint32_t now) {
        if (have_same_bits(boxes_[entry], box)) return false;
        boxes_[entry] = box;
        moving_boxes_.unstage(entry);
        last_moved_[entry] = now;
        changed_ = true;
        return true;
    }
    // In the commit() of the same `now`. Of several the last counts.
    void stage(std::size_t entry, const Obb& box, std::uint32_t now) {
        const auto only = static_cast<std::uint32_t>(entry);
        moving_boxes_.unstage(entry);
        differs_[entry] = !have_same_bits(boxes_[entry], box);
        keep({&only, 1}, &box, sizeof box, now);
    }
    // Likewise many, whose boxes are `stride` bytes apart, up to the first that is not certainly valid. Returns how
    // many.
    std::size_t stage(std::span<const std::uint32_t> entries, const Obb* first, std::size_t stride, std::uint32_t now) {
        const std::size_t count = moving_boxes_.stage(entries, first, stride, boxes_.data(), differs_.data());
        keep(entries.first(count), first, stride, now);
        return count;
    }
    // Takes over what has been staged. Appends the items whose boxes have changed.
    void commit(std::uint32_t now, Vector<ItemId>& moved);
    // Appends the items that have not moved for so many updates.
    void list_rested(std::uint32_t now, std::uint32_t updates, Vector<ItemId>& rested);

    // Makes the list's boxes what views see, and room for the next frame's.
    void update(Executor& executor);

  private:
    // Whether each differs is known.
    void keep(std::span<const std::uint32_t> entries, const Obb* first, std::size_t stride, std::uint32_t now);

    Vector<ItemId> items_;
    Vector<Obb> boxes_, staged_boxes_;
    Vector<std::uint32_t> last_moved_, staged_for_;  // the second: the update that the staged box is for
    Vector<std::uint8_t> differs_;                   // the staged box from the box
    std::size_t staged_count_ = 0, differing_count_ = 0;
    bool staged_twice_ = false;
    std::uint32_t earliest_ = 0;  // no last_moved_ is below
    bool changed_ = false;        // since the last update()
    cull::MovingBoxes moving_boxes_;
};

}  // namespace crofton::world
