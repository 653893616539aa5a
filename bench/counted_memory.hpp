// SPDX-License-Identifier: MIT
// Counts the bytes that the library has in use while this lives.
#pragma once
#include <algorithm>
#include <crofton/core/memory.hpp>
#include <cstddef>
#include <cstdlib>

namespace crofton::bench {

class CountedMemory {
  public:
    CountedMemory() {
        set_memory_hooks({[](void* self, std::size_t bytes, std::size_t alignment) {
                              auto& count = *static_cast<CountedMemory*>(self);
                              count.in_use += bytes;
                              count.most_in_use = std::max(count.most_in_use, count.in_use);
                              return std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
                          },
                          [](void* self, void* memory, std::size_t bytes, std::size_t) {
                              static_cast<CountedMemory*>(self)->in_use -= bytes;
                              std::free(memory);
                          },
                          this});
    }
    ~CountedMemory() { reset_memory_hooks(); }
    CountedMemory(const CountedMemory&) = delete;
    CountedMemory& operator=(const CountedMemory&) = delete;

    std::size_t in_use = 0, most_in_use = 0;
};

}  // namespace crofton::bench
