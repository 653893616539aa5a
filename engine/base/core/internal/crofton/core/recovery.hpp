// SPDX-License-Identifier: MIT
// Operations that hand back an Error where the host has no memory, instead of ending the program.
#pragma once
#include <atomic>
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <new>
#include <utility>

namespace crofton::detail {

// While one lives, a failed allocation of this thread throws std::bad_alloc; otherwise it ends the program with a
// message. The engine is compiled with exceptions for this one purpose: none crosses the API.
class Recovery {
  public:
    Recovery();
    ~Recovery();
    Recovery(const Recovery&) = delete;
    Recovery& operator=(const Recovery&) = delete;
    [[nodiscard]] static bool is_nested();  // two live on this thread
};

// The operation's result, or ErrorCode::out_of_memory. What the operation had built is destroyed by then. An object
// that it changes must be changed by steps that cannot fail, after all that can. Within another operation it throws on
// to that one's: no operation continues with half of the memory it asked for.
template <class Operation>
[[nodiscard]] auto recover(Operation&& operation) -> decltype(operation()) {
    const Recovery recovery;
    try {
        return operation();
    } catch (const std::bad_alloc&) {
        if (Recovery::is_nested()) throw;
        return fail(ErrorCode::out_of_memory, kNoItem, "out of memory");  // short: the text itself allocates nothing
    }
}

// As a failed allocation: throws std::bad_alloc while a Recovery lives, else ends the program with a message.
[[noreturn]] void give_up();

// The value of an operation that fails only if memory runs out.
template <class T>
[[nodiscard]] T value_or_give_up(Result<T> result) {
    if (!result) give_up();
    return std::move(*result);
}

// For operations whose other errors are handled separately.
template <class T>
void give_up_without_memory(const Result<T>& result) {
    if (!result && result.error().code == ErrorCode::out_of_memory) give_up();
}

// As executor.parallel_for within an operation: an allocation that fails in a body, on whichever thread, is thrown
// here after all bodies have returned. Bodies that have not begun by then are skipped.
template <class Body>
void recoverable_for(Executor& executor, std::size_t count, std::size_t grain, Body&& body) {
    std::atomic<bool> failed{false};
    executor.parallel_for(count, grain, [&](std::size_t begin, std::size_t end, unsigned worker) {
        if (failed.load(std::memory_order_relaxed)) return;
        const Recovery recovery;
        try {
            body(begin, end, worker);
        } catch (const std::bad_alloc&) {
            failed.store(true, std::memory_order_relaxed);
        }
    });
    if (failed.load(std::memory_order_relaxed)) throw std::bad_alloc();
}

}  // namespace crofton::detail
