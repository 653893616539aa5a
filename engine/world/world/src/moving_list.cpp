// SPDX-License-Identifier: MIT
#include "moving_list.hpp"
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/consecutive.hpp>

#include <algorithm>
#include <utility>

namespace crofton::world {

std::uint32_t MovingList::add(ItemId item, const Obb& box, std::uint32_t last_moved) {
    const auto entry = static_cast<std::uint32_t>(items_.size());
    items_.push_back(item);
    boxes_.push_back(box);
    last_moved_.push_back(last_moved);
    staged_for_.push_back(0);
    differs_.push_back(0);
    earliest_ = std::min(earliest_, last_moved);
    changed_ = true;
    moving_boxes_.unstage(entry);
    return entry;
}

void MovingList::remove(std::size_t entry) {
    const auto fill = [&](auto& values) {
        values[entry] = values.back();
        values.pop_back();
    };
    fill(items_);
    fill(boxes_);
    fill(last_moved_);
    fill(staged_for_);
    fill(differs_);
    changed_ = true;
    moving_boxes_.unstage(entry);
}

void MovingList::keep(std::span<const std::uint32_t> entries, const Obb* first, std::size_t stride, std::uint32_t now) {
    if (entries.empty()) return;
    // In registers: what is written below might be them.
    Obb* const staged = staged_boxes_.data();
    std::uint32_t* const staged_for = staged_for_.data();
    const std::uint8_t* const differs = differs_.data();
    const auto box_at = [first, stride](std::size_t i) -> const Obb& {
        return *reinterpret_cast<const Obb*>(reinterpret_cast<const std::byte*>(first) + i * stride);
    };
    std::uint32_t fresh = 0, differing = 0;
    if (are_consecutive(entries)) {  // the same in plain loops, at the speed of memory
        const std::size_t begin = entries[0], count = entries.size();
        if (stride == sizeof(Obb))
            std::copy_n(first, count, staged + begin);
        else
            for (std::size_t i = 0; i < count; ++i) staged[begin + i] = box_at(i);
        for (std::size_t i = 0; i < count; ++i) differing += differs[begin + i];
        for (std::size_t i = 0; i < count; ++i) fresh += staged_for[begin + i] != now;
        std::fill_n(staged_for + begin, count, now);
    } else {
        for (std::size_t i = 0; i < entries.size(); ++i) {
            const std::uint32_t entry = entries[i];
            staged[entry] = box_at(i);
            differing += differs[entry];
            fresh += staged_for[entry] != now;
            staged_for[entry] = now;
        }
    }
    staged_count_ += fresh;
    differing_count_ += differing;
    staged_twice_ |= fresh != entries.size();
}

// Where most boxes are staged, the arrays change places and the others are copied.
void MovingList::commit(std::uint32_t now, Vector<ItemId>& moved) {
    if (staged_count_ == 0) return;
    const std::size_t moved_before = moved.size();
    const std::size_t differing = std::exchange(differing_count_, 0);
    if (!std::exchange(staged_twice_, false) && differing == items_.size()) {
        moved.insert(moved.end(), items_.begin(), items_.end());
        std::fill(last_moved_.begin(), last_moved_.end(), now);
        std::swap(boxes_, staged_boxes_);
        staged_count_ = 0;
        changed_ = true;
        return;
    }
    const bool most = staged_count_ * 2 > items_.size();
    moved.resize(moved_before + staged_count_);
    ItemId* end = moved.data() + moved_before;
    for (std::size_t entry = 0; entry < items_.size(); ++entry) {
        const bool is_staged = staged_for_[entry] == now;
        if (is_staged && differs_[entry]) {
            last_moved_[entry] = now;
            *end++ = items_[entry];
            if (!most) boxes_[entry] = staged_boxes_[entry];
        } else if (most && !is_staged) {
            staged_boxes_[entry] = boxes_[entry];
        }
    }
    moved.resize(static_cast<std::size_t>(end - moved.data()));
    staged_count_ = 0;
    if (moved.size() == moved_before) return;
    if (most) std::swap(boxes_, staged_boxes_);
    changed_ = true;
}

void MovingList::list_rested(std::uint32_t now, std::uint32_t updates, Vector<ItemId>& rested) {
    const auto has_rested = [&](std::uint32_t last_moved) { return last_moved <= now && now - last_moved >= updates; };
    if (!has_rested(earliest_)) return;
    earliest_ = ~std::uint32_t{0};
    for (std::size_t entry = 0; entry < items_.size(); ++entry) {
        earliest_ = std::min(earliest_, last_moved_[entry]);
        if (has_rested(last_moved_[entry])) rested.push_back(items_[entry]);
    }
}

void MovingList::update(Executor& executor) {
    if (!changed_) return moving_boxes_.unstage_all();
    changed_ = false;
    if (staged_boxes_.capacity() < items_.size()) staged_boxes_.reserve(boxes_.capacity());
    staged_boxes_.resize(items_.size());
    moving_boxes_.finish(items_, boxes_, executor);
}

}  // namespace crofton::world
