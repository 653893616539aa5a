#include <crofton/core/memory.hpp>
#include <cstdio>
#include <cstdlib>
#include <new>

namespace crofton {
namespace {

void* default_allocate(void*, std::size_t bytes, std::size_t alignment) {
    void* memory = ::operator new(bytes, std::align_val_t{alignment}, std::nothrow);
    if (!memory) {
        std::fprintf(stderr, "crofton: out of memory for %zu bytes\n", bytes);
        std::abort();
    }
    return memory;
}

void default_release(void*, void* memory, std::size_t, std::size_t alignment) {
    ::operator delete(memory, std::align_val_t{alignment});
}

constexpr MemoryHooks kDefaultHooks{default_allocate, default_release, nullptr};
MemoryHooks hooks_in_force = kDefaultHooks;

}  // namespace

void set_memory_hooks(const MemoryHooks& hooks) { hooks_in_force = hooks; }
void reset_memory_hooks() { hooks_in_force = kDefaultHooks; }

void* detail::allocate(std::size_t bytes, std::size_t alignment) {
    return hooks_in_force.allocate(hooks_in_force.user, bytes, alignment);
}

void detail::release(void* memory, std::size_t bytes, std::size_t alignment) {
    if (memory) hooks_in_force.release(hooks_in_force.user, memory, bytes, alignment);
}

}  // namespace crofton
