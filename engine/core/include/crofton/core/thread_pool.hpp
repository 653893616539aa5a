// SPDX-License-Identifier: MIT
// A plain pool of std::threads behind the Executor hook, for hosts without a job system.
#pragma once
#include <crofton/core/executor.hpp>
#include <memory>

namespace crofton {

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
    std::unique_ptr<State> state_;
};

}  // namespace crofton
