// SPDX-License-Identifier: MIT
// Memory that ends: the n-th allocation fails, from the hooks and from operator new alike.
#pragma once
#include <atomic>
#include <crofton/core/memory.hpp>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <new>

namespace crofton::testing {

inline constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
inline std::atomic<std::int64_t> allocations_left{kNever};  // until one fails; all that follow succeed
inline std::atomic<std::int64_t> live_blocks{0};
inline std::atomic<bool> has_failed{false};

[[nodiscard]] inline void* allocate_or_fail(std::size_t bytes, std::size_t alignment) {
    if (allocations_left.load() != kNever && allocations_left.fetch_sub(1) == 0) {
        allocations_left = kNever;
        has_failed = true;
        return nullptr;
    }
    void* memory = std::aligned_alloc(alignment, (bytes + alignment) / alignment * alignment);
    if (memory) ++live_blocks;
    return memory;
}

inline void release(void* memory) {
    if (memory) --live_blocks;
    std::free(memory);
}

// While it lives, the engine's memory comes from allocate_or_fail.
class FailingMemory {
  public:
    FailingMemory() {
        set_memory_hooks(
            {[](void*, std::size_t bytes, std::size_t alignment) { return allocate_or_fail(bytes, alignment); },
             [](void*, void* memory, std::size_t, std::size_t) { release(memory); }, nullptr});
    }
    ~FailingMemory() { reset_memory_hooks(); }
    FailingMemory(const FailingMemory&) = delete;
    FailingMemory& operator=(const FailingMemory&) = delete;
};

}  // namespace crofton::testing
