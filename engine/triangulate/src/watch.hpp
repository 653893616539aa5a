// When to stop: time, the caller's wish.
#pragma once
#include <algorithm>
#include <chrono>
#include <crofton/triangulate/triangulate.hpp>

namespace crofton::triangulate {

class Watch {
  public:
    explicit Watch(const Options& options) : options_(options), limited_(options.seconds < 1e9) {
        if (limited_) {
            const std::chrono::duration<double> allowed(options.seconds > 0.0 ? options.seconds : 0.0);
            deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(allowed);
        }
    }

    // Cheap enough for inner loops: the clock is read and the caller told only when so many steps of some 10 ns have
    // been made since the last time.
    [[nodiscard]] bool stopped(double fraction, std::size_t steps) {
        if (!stopped_ && (steps_ += steps) >= kStepsBetween) check(fraction);
        return stopped_;
    }
    [[nodiscard]] bool stopped_now(double fraction) {
        if (!stopped_) check(fraction);
        return stopped_;
    }
    [[nodiscard]] bool cancelled() const { return cancelled_; }

  private:
    using Clock = std::chrono::steady_clock;

    static constexpr std::size_t kStepsBetween = 1 << 14;

    void check(double fraction) {
        steps_ = 0;
        fraction_ = std::max(fraction_, fraction);
        cancelled_ = options_.progress != nullptr && !options_.progress(options_.user, fraction_);
        stopped_ = cancelled_ || (limited_ && Clock::now() >= deadline_);
    }

    const Options& options_;
    Clock::time_point deadline_{};
    std::size_t steps_ = 0;
    double fraction_ = 0.0;
    bool limited_ = false, stopped_ = false, cancelled_ = false;
};

}  // namespace crofton::triangulate
