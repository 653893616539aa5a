// SPDX-License-Identifier: MIT
// A large vector that never moves its elements.
#pragma once
#include <crofton/core/memory.hpp>
#include <cstddef>

namespace crofton {

// A vector in pages, each of which is taken when the first of its elements comes: appending takes as long however many
// there are. clear() keeps the memory.
template <class T, std::size_t kPage>
class PagedVector {
  public:
    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] const T& operator[](std::size_t i) const { return pages_[i / kPage][i % kPage]; }
    [[nodiscard]] T& operator[](std::size_t i) { return pages_[i / kPage][i % kPage]; }
    void push_back(const T& value) {
        if (size_ == pages_.size() * kPage) Vector<T>(kPage).swap(pages_.emplace_back());
        (*this)[size_] = value;
        ++size_;
    }
    void clear() { size_ = 0; }

  private:
    Vector<Vector<T>> pages_;  // of kPage elements
    std::size_t size_ = 0;
};

}  // namespace crofton
