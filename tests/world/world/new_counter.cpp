// SPDX-License-Identifier: MIT
#include "new_counter.hpp"

#include <atomic>
#include <cstdlib>
#include <new>

#include "aligned_memory.hpp"

namespace {

std::atomic<std::size_t> calls = 0;

[[maybe_unused]] void* counted(std::size_t bytes, std::size_t alignment) {
    ++calls;
    void* memory = crofton::testing::aligned_block(bytes, alignment);
    if (!memory) std::abort();
    return memory;
}

}  // namespace

// Clang's thread sanitizer has operators of its own, which cannot be replaced: nothing is counted there.
#ifdef __has_feature
#define CROFTON_OWN_NEW !__has_feature(thread_sanitizer)
#else
#define CROFTON_OWN_NEW 1
#endif

#if CROFTON_OWN_NEW
void* operator new(std::size_t bytes) {
    return counted(bytes, alignof(std::max_align_t));
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
    return counted(bytes, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
    return counted(bytes, alignof(std::max_align_t));
}
void* operator new(std::size_t bytes, std::align_val_t alignment, const std::nothrow_t&) noexcept {
    return counted(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
    crofton::testing::free_block(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    crofton::testing::free_block(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    crofton::testing::free_block(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    crofton::testing::free_block(memory);
}
#endif

std::size_t crofton::testing::operator_news() {
    return calls;
}
