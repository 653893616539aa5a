// SPDX-License-Identifier: MIT
// Crofton's work on oneTBB's threads.
#pragma once
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <crofton/core/executor.hpp>

namespace crofton::samples {

// Runs in an arena of its own, so that the number of workers is known and fixed.
class TbbExecutor final : public Executor {
  public:
    explicit TbbExecutor(int threads = tbb::this_task_arena::max_concurrency()) : arena_(threads) {
        arena_.initialize();
    }

    [[nodiscard]] unsigned concurrency() const override { return static_cast<unsigned>(arena_.max_concurrency()); }

    // The ranges are made here and handed out one by one: they must not depend on how oneTBB would split.
    void parallel_for(std::size_t count, std::size_t grain, RangeTask body) override {
        const std::size_t ranges = count / grain + (count % grain != 0 ? 1 : 0);
        arena_.execute([&] {
            tbb::parallel_for(
                tbb::blocked_range<std::size_t>(0, ranges, 1),
                [&](const tbb::blocked_range<std::size_t>& some) {
                    const auto worker = static_cast<unsigned>(tbb::this_task_arena::current_thread_index());
                    for (std::size_t i = some.begin(); i != some.end(); ++i)
                        body(i * grain, std::min(count, (i + 1) * grain), worker);
                },
                tbb::simple_partitioner());
        });
    }

  private:
    mutable tbb::task_arena arena_;
};

}  // namespace crofton::samples
