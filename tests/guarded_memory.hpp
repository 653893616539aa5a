// SPDX-License-Identifier: MIT
// Sees what the engine writes behind the end of its blocks, however far, while it lives.
#pragma once
#include <atomic>
#include <crofton/core/memory.hpp>
#include <cstddef>
#include <cstring>

#include "aligned_memory.hpp"

namespace crofton::testing {

// Each block has another as large behind it, whose bytes must stay as they are.
class GuardedMemory {
  public:
    GuardedMemory() { set_memory_hooks({allocate, release, this}); }
    ~GuardedMemory() { reset_memory_hooks(); }
    GuardedMemory(const GuardedMemory&) = delete;
    GuardedMemory& operator=(const GuardedMemory&) = delete;

    // Blocks, of those released so far, that were written beyond.
    [[nodiscard]] std::size_t overrun() const { return overrun_; }

  private:
    static constexpr int kMark = 0xa5;
    static std::size_t guard_of(std::size_t bytes) { return bytes + 4096; }

    static void* allocate(void*, std::size_t bytes, std::size_t alignment) {
        auto* const block = static_cast<unsigned char*>(aligned_block(bytes + guard_of(bytes), alignment));
        if (block) std::memset(block + bytes, kMark, guard_of(bytes));
        return block;
    }
    static void release(void* self, void* memory, std::size_t bytes, std::size_t) {
        const auto* const block = static_cast<const unsigned char*>(memory);
        for (std::size_t i = 0; i < guard_of(bytes); ++i)
            if (block[bytes + i] != kMark) {
                ++static_cast<GuardedMemory*>(self)->overrun_;
                break;
            }
        free_block(memory);
    }

    std::atomic<std::size_t> overrun_ = 0;
};

}  // namespace crofton::testing
