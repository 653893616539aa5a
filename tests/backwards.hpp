// SPDX-License-Identifier: MIT
// An executor that calls in the order that is hardest: the last range first.
#pragma once
#include <algorithm>
#include <crofton/core/executor.hpp>
#include <cstddef>

namespace crofton::testing {

// Says that it has `threads`.
class Backwards final : public Executor {
  public:
    explicit Backwards(unsigned threads) : threads_(threads) {}
    [[nodiscard]] unsigned concurrency() const override { return threads_; }
    void parallel_for(std::size_t count, std::size_t grain, RangeTask body) override {
        for (std::size_t i = (count + grain - 1) / grain; i-- > 0;)
            body(i * grain, std::min(count, (i + 1) * grain), static_cast<unsigned>(i % threads_));
    }

  private:
    unsigned threads_;
};

}  // namespace crofton::testing
