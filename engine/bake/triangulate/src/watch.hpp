// SPDX-License-Identifier: MIT
// When to stop: work, time, the caller's wish.
#pragma once
#include <algorithm>
#include <chrono>
#include <crofton/triangulate/triangulate.hpp>

namespace crofton::triangulate {

class Watch {
  public:
    explicit Watch(const TriangulateOptions& options) : options_(options), limited_(options.seconds < 1e9) {
        if (limited_) {
            const std::chrono::duration<double> allowed(options.seconds > 0.0 ? options.seconds : 0.0);
            deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(allowed);
        }
    }

    // Counts so many steps of some 10 ns. Cheap enough for inner loops: the clock is read and the caller told only when
    // many have been made since the last time.
    [[nodiscard]] bool stopped(double fraction, std::size_t steps) {
        steps_ += steps;
        if (!stopped_ && steps_ >= next_check_) check(fraction);
        return stopped_;
    }
    [[nodiscard]] bool stopped_now(double fraction) {
        if (!stopped_) check(fraction);
        return stopped_;
    }
    // So far, the same in every run.
    [[nodiscard]] std::uint64_t steps() const { return steps_; }
    [[nodiscard]] bool cancelled() const { return cancelled_; }

  private:
    using Clock = std::chrono::steady_clock;

    static constexpr std::uint64_t kStepsBetween = 1 << 14;

    void check(double fraction) {
        // Work ends exactly where it is used up.
        next_check_ = std::min(steps_ + kStepsBetween, std::max(options_.work, steps_ + 1));
        fraction_ = std::max(fraction_, fraction);
        cancelled_ = options_.progress != nullptr && !options_.progress(options_.user, fraction_);
        stopped_ = cancelled_ || steps_ >= options_.work || (limited_ && Clock::now() >= deadline_);
    }

    const TriangulateOptions& options_;
    Clock::time_point deadline_{};
    std::uint64_t steps_ = 0, next_check_ = 0;
    double fraction_ = 0.0;
    bool limited_ = false, stopped_ = false, cancelled_ = false;
};

}  // namespace crofton::triangulate
