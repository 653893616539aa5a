// SPDX-License-Identifier: MIT
// A list that is made anew for each view.
#pragma once
#include <algorithm>
#include <crofton/core/raw_buffer.hpp>
#include <cstddef>
#include <span>

namespace crofton::cull {

// Keeps its memory, and writes no value twice.
template <class T>
class AnswerList {
  public:
    void clear() { size_ = 0; }
    // Room for as many more behind the end, to be written and then taken by grow().
    [[nodiscard]] T* room(std::size_t count) { return values_.room(size_ + count, size_) + size_; }
    void grow(std::size_t count) { size_ += count; }
    [[nodiscard]] T* extend(std::size_t count) {
        T* const to = room(count);
        grow(count);
        return to;
    }
    void add(std::span<const T> values) { std::copy(values.begin(), values.end(), extend(values.size())); }
    void add(const T& value) { *extend(1) = value; }
    [[nodiscard]] std::span<const T> values() const { return {values_.data(), size_}; }
    [[nodiscard]] std::size_t size() const { return size_; }

  private:
    RawBuffer<T> values_;
    std::size_t size_ = 0;
};

}  // namespace crofton::cull
