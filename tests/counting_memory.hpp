// SPDX-License-Identifier: MIT
// Counts what the engine allocates while it lives, on any thread.
#pragma once
#include <algorithm>
#include <atomic>
#include <crofton/core/memory.hpp>
#include <cstddef>

#include "aligned_memory.hpp"

namespace crofton::testing {

class CountingMemory {
  public:
    CountingMemory() { set_memory_hooks({allocate, release, this}); }
    ~CountingMemory() { reset_memory_hooks(); }
    CountingMemory(const CountingMemory&) = delete;
    CountingMemory& operator=(const CountingMemory&) = delete;

    [[nodiscard]] std::size_t allocations() const { return allocations_; }
    [[nodiscard]] std::size_t bytes_in_use() const { return bytes_in_use_; }
    [[nodiscard]] std::size_t bytes_taken() const { return bytes_taken_; }  // of all allocations so far
    // The lesser of what was taken and given back since both were so many: an array that is copied at once is in both.
    [[nodiscard]] std::size_t bytes_replaced_since(std::size_t taken, std::size_t in_use) const {
        const std::size_t taken_since = bytes_taken_ - taken;
        return std::min(taken_since, in_use + taken_since - bytes_in_use_);
    }

  private:
    static void* allocate(void* self, std::size_t bytes, std::size_t alignment) {
        ++static_cast<CountingMemory*>(self)->allocations_;
        static_cast<CountingMemory*>(self)->bytes_in_use_ += bytes;
        static_cast<CountingMemory*>(self)->bytes_taken_ += bytes;
        return aligned_block(bytes, alignment);
    }
    static void release(void* self, void* memory, std::size_t bytes, std::size_t) {
        static_cast<CountingMemory*>(self)->bytes_in_use_ -= bytes;
        free_block(memory);
    }

    std::atomic<std::size_t> allocations_ = 0, bytes_in_use_ = 0, bytes_taken_ = 0;
};

}  // namespace crofton::testing
