// SPDX-License-Identifier: MIT
// Where the engine's containers get their memory: the host's allocator, when it gives one.
#pragma once
#include <crofton/core/version.hpp>
#include <cstddef>
#include <vector>

namespace crofton {

// Both functions may be called from any thread. `allocate` returns memory aligned to `alignment`, a power of two, or
// nullptr where the host has none. Then what builds, loads, bakes, fits or triangulates returns
// ErrorCode::out_of_memory and has changed nothing (docs/testing.md has the list); elsewhere the program ends with a
// message (std::abort).
struct MemoryHooks {
    void* (*allocate)(void* user, std::size_t bytes, std::size_t alignment);
    void (*release)(void* user, void* memory, std::size_t bytes, std::size_t alignment);
    void* user;
};

// Replaces the hooks; call it before any other call into the engine, since memory is released through the hooks in
// force.
void set_memory_hooks(const MemoryHooks& hooks);
void reset_memory_hooks();

namespace detail {
[[nodiscard]] void* allocate(std::size_t bytes, std::size_t alignment);
[[nodiscard]] void* try_allocate(std::size_t bytes, std::size_t alignment);  // nullptr where the host has no memory
void release(void* memory, std::size_t bytes, std::size_t alignment);
}  // namespace detail

// A standard allocator over the hooks; blocks are aligned for the widest vector loads.
template <class T>
struct Allocator {
    using value_type = T;
    static constexpr std::size_t kAlignment = alignof(T) > 64 ? alignof(T) : 64;

    Allocator() = default;
    template <class U>
    Allocator(const Allocator<U>&) {}

    T* allocate(std::size_t count) { return static_cast<T*>(detail::allocate(count * sizeof(T), kAlignment)); }
    void deallocate(T* memory, std::size_t count) { detail::release(memory, count * sizeof(T), kAlignment); }
    template <class U>
    bool operator==(const Allocator<U>&) const {
        return true;
    }
};

template <class T>
using Vector = std::vector<T, Allocator<T>>;

}  // namespace crofton
