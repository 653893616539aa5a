// SPDX-License-Identifier: MIT
// Work handed to the host's threads: callables by reference, the hook, and a pool for hosts without a job system.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/core/version.hpp>
#include <cstddef>
#include <type_traits>
#include <utility>

namespace crofton {

// A callable by reference: two words, no allocation; valid only while the callable lives.

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

// The engine owns no threads: work is handed to the host's, through this hook.

// body(begin, end, worker) does the items [begin, end). worker < concurrency(), and no two bodies run at once on one
// worker. So it may index scratch memory of each worker.
using RangeTask = FunctionRef<void(std::size_t begin, std::size_t end, unsigned worker)>;

class Executor {
  public:
    virtual ~Executor() = default;

    // How many bodies may run at once; at least 1, and the same for the executor's life.
    [[nodiscard]] virtual unsigned concurrency() const = 0;

    // Calls `body` for the ranges [0, grain), [grain, 2·grain), … of [0, count), in any order and on any threads, and
    // returns when all are done. The ranges depend on count and grain alone, so a body that writes only its own range's
    // output gives the same bits with any executor. Requires grain ≥ 1. Bodies do not throw.
    virtual void parallel_for(std::size_t count, std::size_t grain, RangeTask body) = 0;
};

// Runs everything on the calling thread, in order. Stateless: may be shared by any number of threads.
[[nodiscard]] Executor& serial_executor();

// A plain pool of std::threads behind the Executor hook, for hosts without a job system.

// One parallel_for at a time: a second caller waits. A body must not call parallel_for of its own pool.
class ThreadPool final : public Executor {
  public:
    // `threads` counts the calling thread, which works too; 0 asks for one per hardware thread.
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
