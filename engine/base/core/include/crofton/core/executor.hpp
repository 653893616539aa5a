// SPDX-License-Identifier: MIT
// References to callables, the interface to the host's threads, and a thread pool for hosts without a job system.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/core/version.hpp>
#include <cstddef>
#include <type_traits>
#include <utility>

namespace crofton {

// Refers to a callable: two words, no allocation. Valid only while the callable lives.

template <class Signature>
class FunctionRef;

template <class R, class... Args>
class FunctionRef<R(Args...)> {
  public:
    template <class F>
    requires(!std::is_same_v<std::remove_cvref_t<F>, FunctionRef> && std::is_invocable_r_v<R, F&, Args...>)
        FunctionRef(F&& callable)
        : object_(&const_cast<char&>(reinterpret_cast<const volatile char&>(callable))),  // std::addressof
          call_([](void* object, Args... args) -> R {
              return (*static_cast<std::remove_reference_t<F>*>(object))(std::forward<Args>(args)...);
          }) {}

    R operator()(Args... args) const { return call_(object_, std::forward<Args>(args)...); }

  private:
    void* object_;
    R (*call_)(void*, Args...);
};

// The engine owns no threads. It passes work to the host's threads through this interface.

// body(begin, end, worker) processes the items [begin, end).
//
// worker < concurrency(), and two bodies never run at once with the same worker. A body may therefore use scratch
// memory indexed by worker.
using RangeTask = FunctionRef<void(std::size_t begin, std::size_t end, unsigned worker)>;

class Executor {
  public:
    virtual ~Executor() = default;

    // Returns how many bodies may run at once: at least 1, and the same for the executor's life.
    [[nodiscard]] virtual unsigned concurrency() const = 0;

    // Calls `body` for the ranges [0, grain), [grain, 2·grain), … of [0, count), in any order and on any threads.
    // Returns when all are done.
    //
    // The ranges depend only on count and grain. A body that writes only its own range's output therefore gives the
    // same bits with any executor. Requires grain ≥ 1. Bodies must not throw.
    virtual void parallel_for(std::size_t count, std::size_t grain, RangeTask body) = 0;
};

// Returns an executor that runs everything on the calling thread, in order. It has no state: any number of threads may
// share it.
[[nodiscard]] Executor& serial_executor();

// An Executor over std::threads, for hosts without a job system.

// Runs one parallel_for at a time; a second caller waits. A body must not call parallel_for of its own pool.
class ThreadPool final : public Executor {
  public:
    // `threads` includes the calling one. 0: one per hardware thread. At most 1024, and no more than the system starts.
    explicit ThreadPool(unsigned threads = 0);
    ~ThreadPool() override;
    ThreadPool(const ThreadPool&) = delete;
    ThreadPool& operator=(const ThreadPool&) = delete;

    [[nodiscard]] unsigned concurrency() const override;
    void parallel_for(std::size_t count, std::size_t grain, RangeTask body) override;

  private:
    struct State;
    Owner<State> state_;
};

}  // namespace crofton
