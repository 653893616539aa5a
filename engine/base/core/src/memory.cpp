// SPDX-License-Identifier: MIT
#include <crofton/core/memory.hpp>
#include <crofton/core/no_recovery.hpp>
#include <crofton/core/recovery.hpp>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <utility>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace crofton {
namespace {

// Large blocks ask for huge pages. A page fault costs as much as filling the page, and a tree of a million items spans
// tens of thousands of ordinary ones.
constexpr std::size_t kLargeBlock = std::size_t{4} << 20, kHugePage = std::size_t{2} << 20;

constexpr std::size_t alignment_of(std::size_t bytes, std::size_t alignment) {
    return bytes >= kLargeBlock && alignment < kHugePage ? kHugePage : alignment;
}

void* default_allocate(void*, std::size_t bytes, std::size_t alignment) {
    void* memory = ::operator new (bytes, std::align_val_t{alignment_of(bytes, alignment)}, std::nothrow);
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    if (memory && bytes >= kLargeBlock) madvise(memory, bytes / kHugePage * kHugePage, MADV_HUGEPAGE);
#endif
    return memory;
}

void default_release(void*, void* memory, std::size_t bytes, std::size_t alignment) {
    ::operator delete (memory, std::align_val_t{alignment_of(bytes, alignment)});
}

constexpr MemoryHooks kDefaultHooks{default_allocate, default_release, nullptr};
MemoryHooks hooks_in_force = kDefaultHooks;
thread_local int recoveries = 0;

}  // namespace

void set_memory_hooks(const MemoryHooks& hooks) {
    hooks_in_force = hooks;
}
void reset_memory_hooks() {
    hooks_in_force = kDefaultHooks;
}

detail::Recovery::Recovery() {
    ++recoveries;
}
detail::Recovery::~Recovery() {
    --recoveries;
}
bool detail::Recovery::is_nested() {
    return recoveries > 1;
}

detail::NoRecovery::NoRecovery() : recoveries_(std::exchange(recoveries, 0)) {}
detail::NoRecovery::~NoRecovery() {
    recoveries = recoveries_;
}

void* detail::try_allocate(std::size_t bytes, std::size_t alignment) {
    return hooks_in_force.allocate(hooks_in_force.user, bytes, alignment);
}

void* detail::allocate(std::size_t bytes, std::size_t alignment) {
    void* memory = try_allocate(bytes, alignment);
    if (!memory) {
        if (recoveries > 0) throw std::bad_alloc();
        std::fprintf(stderr, "crofton: out of memory for %zu bytes\n", bytes);
        std::abort();
    }
    return memory;
}

void detail::give_up() {
    if (recoveries > 0) throw std::bad_alloc();
    std::fprintf(stderr, "crofton: out of memory\n");
    std::abort();
}

void detail::release(void* memory, std::size_t bytes, std::size_t alignment) {
    if (memory) hooks_in_force.release(hooks_in_force.user, memory, bytes, alignment);
}

}  // namespace crofton
