// SPDX-License-Identifier: MIT
// A large vector that grows by a few elements at a time.
#pragma once
#include <algorithm>
#include <crofton/core/memory.hpp>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace crofton {

// A vector that is copied to larger memory in parts, so that no call takes as long as copying all of it.
//
// Once little room is left, each append() copies a part of the elements to the next memory, which takes over when it
// has them all. Until then an element that changes is copied again. All functions but set() and edit() invalidate
// references. Small vectors are copied at once, and all if many elements are appended.
template <class T>
class GrowingVector {
  public:
    static_assert(std::is_trivially_copyable_v<T>, "elements are copied without their constructors");

    [[nodiscard]] std::size_t size() const { return values_.size(); }
    [[nodiscard]] std::size_t capacity() const { return values_.capacity(); }
    [[nodiscard]] bool empty() const { return values_.empty(); }
    [[nodiscard]] const T* begin() const { return values_.data(); }
    [[nodiscard]] const T* end() const { return values_.data() + values_.size(); }
    [[nodiscard]] const T* data() const { return values_.data(); }
    [[nodiscard]] const T& operator[](std::size_t i) const { return values_[i]; }
    [[nodiscard]] std::span<const T> view() const { return values_; }

    // Returns an element to write, until the next settle(). After edit_all(), several threads may write different
    // elements, until the next append().
    [[nodiscard]] T& edit(std::size_t i) {
        if (i < next_.size()) note(i);
        return values_[i];
    }
    [[nodiscard]] T* edit_some(std::span<const std::uint32_t> some) {
        for (const std::uint32_t i : some)
            if (i < next_.size()) note(i);
        return values_.data();
    }
    T* edit_all() {
        stop_growing();
        return values_.data();
    }
    void set(std::size_t i, const T& value) {
        values_[i] = value;
        if (i < next_.size()) next_[i] = value;
    }

    void reserve(std::size_t capacity) {
        stop_growing();
        values_.reserve(capacity);
    }
    // Takes memory for so many, and for the room that is left when copying begins. Writes it once, so that no element
    // that is appended later waits for a page of it.
    void reserve_pages(std::size_t count) {
        const std::size_t capacity = count + count / (kRoomPart - 1) + 1, size = values_.size();
        if (capacity <= values_.capacity()) return;
        reserve(capacity);
        values_.resize(capacity);
        values_.resize(size);
    }
    void resize(std::size_t size, const T& value = T()) {
        stop_growing();
        values_.resize(size, value);
    }
    void assign(std::size_t size, const T& value) {
        stop_growing();
        values_.assign(size, value);
    }
    void clear() { resize(0); }

    // Takes memory for `count` more, after which appending them takes none. Where there is no room, takes an eighth
    // more than there is, and a 16th more than `count`, so that the next few are not copied at once.
    void make_room(std::size_t count) {
        const std::size_t most = values_.capacity();
        if (values_.size() + count > most) {
            stop_growing();
            values_.reserve(values_.size() + std::max(values_.size() / 8, count / 16) + count + 16);
        } else if (next_.capacity() == 0 && most * sizeof(T) > kSmall && (most - values_.size()) < most / kRoomPart) {
            edited_.reserve(kMostEdited);
            next_.reserve(most + most / 8);
        }
    }
    void append(std::size_t count, const T& value) {
        if (count == 0) return;
        make_room(count);
        // Ends shortly before the room that is left now is used.
        const std::size_t left = values_.capacity() - values_.size() - count, room = left - left / 8;
        values_.resize(values_.size() + count, value);
        if (next_.capacity() > 0) copy((values_.size() - next_.size()) / (room / count + 1) + count);
    }
    void append(const T& value) { append(1, value); }
    void append(std::span<const T> values) {  // copies all where there is no room
        stop_growing();
        values_.insert(values_.end(), values.begin(), values.end());
    }

    // Copies what has changed, and some more. Call it now and then where elements change.
    void settle() {
        if (next_.capacity() > 0) copy(edited_.size() + kSmall / 32 / sizeof(T) + 1);
    }

    // Copies the rest at once.
    void finish() {
        if (next_.capacity() > 0) copy(values_.size());
    }

  private:
    static constexpr std::size_t kSmall = std::size_t{1} << 15;  // bytes
    static constexpr std::size_t kRoomPart = 32, kMostEdited = 1024;

    void note(std::size_t i) {
        if (!edited_.empty() && edited_.back() == i) return;
        if (edited_.size() == kMostEdited) return stop_growing();
        edited_.push_back(static_cast<std::uint32_t>(i));
    }
    void copy(std::size_t count) {
        for (const std::uint32_t i : edited_) next_[i] = values_[i];
        edited_.clear();
        const auto rest = view().subspan(next_.size());
        const auto some = rest.first(std::min(rest.size(), count));
        next_.insert(next_.end(), some.begin(), some.end());
        if (some.size() < rest.size()) return;
        values_.swap(next_);
        stop_growing();
    }
    void stop_growing() {
        if (next_.capacity() == 0) return;
        Vector<T>().swap(next_);
        Vector<std::uint32_t>().swap(edited_);
    }

    Vector<T> values_, next_;       // the second: the first elements, in larger memory; without any: nothing grows
    Vector<std::uint32_t> edited_;  // those that have been copied and may have changed since
};

}  // namespace crofton
