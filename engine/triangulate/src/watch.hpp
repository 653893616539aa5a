// When to stop: time, the caller's wish.
#pragma once
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

    // Cheap enough for inner loops: the clock is read and the caller told every 64th time only.
    [[nodiscard]] bool stopped(double fraction) {
        if (!stopped_ && ++ticks_ % 64 == 0) check(fraction);
        return stopped_;
    }
    [[nodiscard]] bool stopped_now(double fraction) {
        if (!stopped_) check(fraction);
        return stopped_;
    }
    [[nodiscard]] bool cancelled() const { return cancelled_; }

  private:
    using Clock = std::chrono::steady_clock;

    void check(double fraction) {
        cancelled_ = options_.progress != nullptr && !options_.progress(options_.user, fraction);
        stopped_ = cancelled_ || (limited_ && Clock::now() >= deadline_);
    }

    const Options& options_;
    Clock::time_point deadline_{};
    std::uint32_t ticks_ = 0;
    bool limited_ = false, stopped_ = false, cancelled_ = false;
};

}  // namespace crofton::triangulate
