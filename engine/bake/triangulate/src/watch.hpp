// SPDX-License-Identifier: MIT
// When to stop: work, time, the caller's wish.
#pragma once
#include <algorithm>
#include <chrono>
#include <crofton/triangulate/triangulate.hpp>

namespace crofton::triangulate {

class Watch {
  public:
    explicit Watch(const TriangulateOptions& options, std::size_t points = 0)
        : options_(options), work_(options.work), limited_(options.seconds < 1e9) {
        if (work_ == TriangulateOptions::kAutomaticWork)
            work_ = limited_ ? TriangulateOptions::kUnlimitedWork : automatic_work(points);
        if (limited_) {
            const std::chrono::duration<double> allowed(options.seconds > 0.0 ? options.seconds : 0.0);
            deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(allowed);
        }
    }

    // Counts so many steps of some 10 ns. Cheap enough for inner loops: the clock is read and the caller notified only
    // when many have been made since the last time.
    [[nodiscard]] bool stopped(double fraction, std::size_t steps) {
        steps_ += steps;
        if (!stopped_ && steps_ >= next_check_) check(fraction);
        return stopped_;
    }
    [[nodiscard]] bool stopped_now(double fraction) {
        if (!stopped_) check(fraction);
        return stopped_;
    }
    // Whether the caller has cancelled. What is done after the search has no limits, but can be cancelled all the same.
    [[nodiscard]] bool cancelled_by_now() {
        if (!cancelled_ && options_.should_stop != nullptr && ++quiet_steps_ % kStepsBetween == 0)
            cancelled_ = options_.should_stop(options_.user, fraction_);
        return cancelled_;
    }
    // So far, the same in every run.
    [[nodiscard]] std::uint64_t steps() const { return steps_; }
    [[nodiscard]] bool cancelled() const { return cancelled_; }

  private:
    using Clock = std::chrono::steady_clock;

    static constexpr std::uint64_t kStepsBetween = 1 << 14;
    static constexpr std::uint64_t kLeastWork = 1'000'000'000, kMostWork = 10'000'000'000, kWorkOfPoint = 50'000;

    static std::uint64_t automatic_work(std::size_t points) {
        return std::clamp(kWorkOfPoint * std::min<std::uint64_t>(points, kMostWork), kLeastWork, kMostWork);
    }

    void check(double fraction) {
        // Work ends exactly where it is used up.
        next_check_ = std::min(steps_ + kStepsBetween, std::max(work_, steps_ + 1));
        fraction_ = std::max(fraction_, fraction);
        cancelled_ = options_.should_stop != nullptr && options_.should_stop(options_.user, fraction_);
        stopped_ = cancelled_ || steps_ >= work_ || (limited_ && Clock::now() >= deadline_);
    }

    const TriangulateOptions& options_;
    std::uint64_t work_;
    Clock::time_point deadline_{};
    std::uint64_t steps_ = 0, next_check_ = 0, quiet_steps_ = 0;
    double fraction_ = 0.0;
    bool limited_ = false, stopped_ = false, cancelled_ = false;
};

}  // namespace crofton::triangulate
