// SPDX-License-Identifier: MIT
// Memory of the engine's containers, from the host's allocator if it sets one.
#pragma once
#include <crofton/core/version.hpp>
#include <cstddef>
#include <new>
#include <vector>

namespace crofton {

// The host's allocator. Both functions may be called from any thread.
//
// `allocate` returns memory aligned to `alignment`, a power of two, or nullptr if the host has none. Functions that
// build, load, bake, fit or triangulate then return ErrorCode::out_of_memory and have changed nothing; docs/testing.md
// has the list. All others end the program with a message (std::abort).
struct MemoryHooks {
    void* (*allocate)(void* user, std::size_t bytes, std::size_t alignment);
    void (*release)(void* user, void* memory, std::size_t bytes, std::size_t alignment);
    void* user;
};

// Replaces the hooks. Call it before any other function of the engine, because memory is released through the hooks
// that are set at that time.
void set_memory_hooks(const MemoryHooks& hooks);
void reset_memory_hooks();

namespace detail {
[[nodiscard]] void* allocate(std::size_t bytes, std::size_t alignment);
[[nodiscard]] void* try_allocate(std::size_t bytes, std::size_t alignment);  // nullptr if the host has no memory
void release(void* memory, std::size_t bytes, std::size_t alignment);
}  // namespace detail

// A standard allocator over the hooks. It aligns blocks for the widest vector loads.
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

// Holds a value that becomes T() when it is moved from, as a moved-from vector becomes empty. A class that has both
// then needs no move functions of its own.
template <class T>
class ResetOnMove {
  public:
    ResetOnMove() = default;
    ResetOnMove(const T& value) : value_(value) {}
    ResetOnMove(const ResetOnMove&) = default;
    ResetOnMove& operator=(const ResetOnMove&) = default;
    ResetOnMove(ResetOnMove&& other) noexcept : value_(other.take()) {}
    ResetOnMove& operator=(ResetOnMove&& other) noexcept {
        value_ = other.take();
        return *this;
    }
    ~ResetOnMove() = default;
    operator const T&() const { return value_; }

  private:
    T take() {
        const T taken = value_;
        value_ = T();
        return taken;
    }
    T value_{};
};

// Owns an object in memory of the hooks; the class may be incomplete for users. It replaces std::unique_ptr, whose
// header would make each file that includes ours compile a third longer.
template <class T>
struct Destroy {
    void operator()(T* object) const {
        object->~T();
        detail::release(object, sizeof(T), alignof(T));
    }
};

template <class T, class Deleter = Destroy<T>>
class Owner {
  public:
    Owner() = default;
    explicit Owner(T* object) : object_(object) {}
    Owner(Owner&& other) noexcept : object_(other.release()) {}
    Owner& operator=(Owner&& other) noexcept {
        T* taken = other.release();  // first, so that moving to itself changes nothing
        Owner old(object_);
        object_ = taken;
        return *this;
    }
    ~Owner() {
        if (object_) Deleter()(object_);
    }

    // Requires the Deleter above.
    template <class... Arguments>
    [[nodiscard]] static Owner make(Arguments&&... arguments) {
        struct Memory {
            void* block = detail::allocate(sizeof(T), alignof(T));
            ~Memory() { detail::release(block, sizeof(T), alignof(T)); }  // if the constructor throws
        } memory;
        Owner made(new (memory.block) T(static_cast<Arguments&&>(arguments)...));
        memory.block = nullptr;
        return made;
    }

    T* get() const { return object_; }
    T& operator*() const { return *object_; }
    T* operator->() const { return object_; }
    explicit operator bool() const { return object_ != nullptr; }
    T* release() {
        T* object = object_;
        object_ = nullptr;
        return object;
    }

  private:
    T* object_ = nullptr;
};

}  // namespace crofton
