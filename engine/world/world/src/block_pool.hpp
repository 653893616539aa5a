// SPDX-License-Identifier: MIT
// Memory for many short arrays that are allocated and freed often.
#pragma once
#include <algorithm>
#include <bit>
#include <crofton/core/memory.hpp>
#include <cstddef>
#include <span>

namespace crofton::world {

// Blocks of 1, 2, 4, … values, which stay where they are. What is given back is kept for the next of its size.
template <class T>
class BlockPool {
  public:
    // At least so many values; give the block back as it is. None: an empty block.
    [[nodiscard]] std::span<T> take(std::size_t count) {
        if (count == 0) return {};
        const auto size_class = static_cast<std::size_t>(std::bit_width(count - 1));
        const std::size_t size = std::size_t{1} << size_class;
        if (free_.size() <= size_class) free_.resize(size_class + 1);
        Vector<T*>& free = free_[size_class];
        if (free.empty()) {
            Vector<T>& chunk = chunks_.emplace_back(std::max(size, kLeastChunk));
            for (std::size_t end = chunk.size(); end > 0; end -= size) free.push_back(chunk.data() + end - size);
        }
        T* const block = free.back();
        free.pop_back();
        return {block, size};
    }
    // Exchanges a block for one that take(count) would give, unless it is as large. What stays in its place stays near.
    void fit(std::span<T>& block, std::size_t count) {
        if (block.size() == (count == 0 ? 0 : std::bit_ceil(count))) return;
        give_back(block);
        block = take(count);
    }
    void give_back(std::span<T> block) {
        if (!block.empty()) free_[static_cast<std::size_t>(std::countr_zero(block.size()))].push_back(block.data());
    }

  private:
    static constexpr std::size_t kLeastChunk = 64;
    Vector<Vector<T>> chunks_;
    Vector<Vector<T*>> free_;  // by the logarithm of their size
};

}  // namespace crofton::world
