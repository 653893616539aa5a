// SPDX-License-Identifier: MIT
// Checks handles, and numbers the states of Worlds. Generations distinguish successive uses of an index, and one World
// from another.
#include <atomic>

#include "object_table.hpp"

namespace crofton::world {

// Multiples of 2^32 over the golden ratio: the first n of them divide the circle into arcs of at least 1 / (φ² n) of it
// (Swierczkowski 1958, the three-gap theorem).
std::uint32_t next_first_generation() {
    static std::atomic<std::uint32_t> worlds{0};
    const std::uint32_t first = 1 + worlds.fetch_add(1, std::memory_order_relaxed) * 0x9e3779b9u;
    return first == 0 ? 1 : first;
}

std::uint64_t next_revision() {
    static std::atomic<std::uint64_t> revisions{0};
    return 1 + revisions.fetch_add(1, std::memory_order_relaxed);
}

Result<void> refuse(const char* thing, std::uint32_t index, std::uint32_t generation,
                    std::span<const std::uint32_t> generations, std::uint32_t first, std::uint64_t item) {
    if (index == kNoIndex || generation == 0)
        return fail(ErrorCode::stale_handle, item, {"world: the handle of the ", thing, " was never set"});
    // Counted from where this World begins: a handle that it gave is not ahead of what the index has now.
    if (index >= generations.size() || generation - first > generations[index] - first)
        return fail(ErrorCode::stale_handle, item,
                    {"world: the handle of ", thing, " ", index, " is of another World: ask the one that gave it"});
    return fail(ErrorCode::stale_handle, item,
                {"world: ", thing, " ", index, " of generation ", generation, " has been removed"});
}

}  // namespace crofton::world
