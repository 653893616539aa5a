// SPDX-License-Identifier: MIT
// Applies a few changes to a long sorted list.
#pragma once
#include <algorithm>
#include <atomic>
#include <crofton/core/memory.hpp>
#include <cstddef>
#include <mutex>
#include <span>

namespace crofton {

// The first of the values from `begin` on that is not before the key; found soon where it is near.
template <class T, class Key, class IsBefore>
[[nodiscard]] std::size_t find_from(std::size_t begin, const Vector<T>& values, const Key& key, IsBefore is_before) {
    std::size_t step = 1, end = begin;
    while (end < values.size() && is_before(values[end], key)) {
        begin = end + 1;
        end = std::min(values.size(), end + step);
        step *= 2;
    }
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(begin),
               last = values.begin() + static_cast<std::ptrdiff_t>(std::max(begin, end));
    return static_cast<std::size_t>(std::lower_bound(first, last, key, is_before) - values.begin());
}

// Removes and inserts values of lists by position. The elements between two changes are moved in one block.
class ListEdits {
  public:
    void begin() {
        stretches_.clear();
        places_.clear();
        begin_ = 0;
        shift_ = 0;
    }
    // In the order of positions in the old list; insertions before a position precede a removal there.
    void remove(std::size_t place) {
        stretches_.push_back({begin_, place, shift_});
        begin_ = place + 1;
        --shift_;
    }
    void add(std::size_t before) {
        stretches_.push_back({begin_, before, shift_});
        places_.push_back(static_cast<std::size_t>(static_cast<std::ptrdiff_t>(before) + shift_));
        begin_ = before;
        ++shift_;
    }
    // Applies the changes to a list. The caller then writes the inserted elements at places().
    template <class T>
    void apply(Vector<T>& list) const {
        if (stretches_.empty()) return;
        const std::size_t size = list.size(),
                          new_size = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(size) + shift_);
        if (new_size > size) list.resize(new_size);
        const auto at = [&](std::size_t i) { return list.begin() + static_cast<std::ptrdiff_t>(i); };
        // Moves blocks leftward from the left and rightward from the right, so that none is overwritten before it has
        // moved.
        for (const Stretch& s : stretches_)
            if (s.shift < 0) std::move(at(s.begin), at(s.end), at(s.begin) + s.shift);
        if (shift_ < 0) std::move(at(begin_), at(size), at(begin_) + shift_);
        if (shift_ > 0) std::move_backward(at(begin_), at(size), at(size) + shift_);
        for (std::size_t n = stretches_.size(); n-- > 0;)
            if (const Stretch& s = stretches_[n]; s.shift > 0)
                std::move_backward(at(s.begin), at(s.end), at(s.end) + s.shift);
        if (new_size < size) list.resize(new_size);
    }
    [[nodiscard]] std::span<const std::size_t> places() const { return places_; }

  private:
    struct Stretch {
        std::size_t begin, end;
        std::ptrdiff_t shift;
    };
    Vector<Stretch> stretches_;
    Vector<std::size_t> places_;
    std::size_t begin_ = 0;  // of the last stretch, which goes to the list's end
    std::ptrdiff_t shift_ = 0;
};

// A sorted list that is updated lazily, when it is read: recording a change takes constant time. One thread changes it;
// any thread may read between changes.
template <class T, class IsBefore>
class LazySortedList {
  public:
    // Requires that added values are not in the list, and that removed ones are.
    void note(std::span<const T> added, std::span<const T> removed) {
        if (added.empty() && removed.empty()) return;
        for (const T& value : removed) edits_.push_back({value, edits_.size(), false});
        for (const T& value : added) edits_.push_back({value, edits_.size(), true});
        is_old_ = true;
        if (edits_.size() > kFewEdits + values_.size() / kMostEdits) (void)get();
    }
    [[nodiscard]] const Vector<T>& get() const {
        if (is_old_.load(std::memory_order_acquire)) {
            const std::lock_guard lock(mutex_);
            if (is_old_.load(std::memory_order_relaxed)) apply();
            is_old_.store(false, std::memory_order_release);
        }
        return values_;
    }
    // For the thread that changes it.
    [[nodiscard]] Vector<T>& values() {
        (void)get();
        return values_;
    }

  private:
    static constexpr std::size_t kFewEdits = 1024, kMostEdits = 8;  // the second: as a part of the list
    struct Edit {
        T value;
        std::size_t number;
        bool is_added;
    };
    // Edits of one value alternate: the first and the last give the result.
    void apply() const {
        const IsBefore is_before;
        std::sort(edits_.begin(), edits_.end(), [&](const Edit& a, const Edit& b) {
            return is_before(a.value, b.value) || (!is_before(b.value, a.value) && a.number < b.number);
        });
        added_.clear();
        list_edits_.begin();
        std::size_t place = 0;
        for (std::size_t begin = 0, end; begin < edits_.size(); begin = end) {
            for (end = begin + 1; end < edits_.size() && !is_before(edits_[begin].value, edits_[end].value); ++end) {
            }
            const bool was_there = !edits_[begin].is_added, is_there = edits_[end - 1].is_added;
            if (!was_there && !is_there) continue;
            place = find_from(place, values_, edits_[begin].value, is_before);
            if (was_there && is_there) {
                values_[place] = edits_[end - 1].value;
            } else if (was_there) {
                list_edits_.remove(place++);
            } else {
                list_edits_.add(place);
                added_.push_back(edits_[end - 1].value);
            }
        }
        list_edits_.apply(values_);
        for (std::size_t n = 0; n < added_.size(); ++n) values_[list_edits_.places()[n]] = added_[n];
        edits_.clear();
    }

    mutable std::mutex mutex_;
    mutable std::atomic<bool> is_old_ = false;
    mutable Vector<T> values_, added_;
    mutable Vector<Edit> edits_;
    mutable ListEdits list_edits_;
};

}  // namespace crofton
