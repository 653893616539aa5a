// SPDX-License-Identifier: MIT
// A StopCallback that many threads may poll.
#pragma once
#include <atomic>
#include <chrono>
#include <crofton/core/error.hpp>
#include <crofton/core/stop.hpp>
#include <cstdint>

namespace crofton::detail {

[[nodiscard]] inline Error cancelled(const char* whose) {
    return fail(ErrorCode::cancelled, kNoItem, {whose, ": the callback asked to stop"});
}

// Asks the caller's callback from any of the threads that work, never from two at once, and some hundred times a second
// at most. Once it has returned true it is not asked again.
class StopSignal {
  public:
    StopSignal(StopCallback should_stop, void* user) : should_stop_(should_stop), user_(user) {}
    StopSignal(const StopSignal&) = delete;
    StopSignal& operator=(const StopSignal&) = delete;

    // Whether the caller wants to stop. May call the callback.
    [[nodiscard]] bool is_raised(double share_done) {
        if (should_stop_ == nullptr) return false;
        if (raised_.load(std::memory_order_relaxed)) return true;
        const std::int64_t now = Clock::now().time_since_epoch().count();
        if (now < next_.load(std::memory_order_relaxed) || asking_.test_and_set(std::memory_order_acquire))
            return false;
        next_.store(now + kBetween.count(), std::memory_order_relaxed);
        if (should_stop_(user_, share_done)) raised_.store(true, std::memory_order_relaxed);
        asking_.clear(std::memory_order_release);
        return raised_.load(std::memory_order_relaxed);
    }
    // Whether the callback has asked to stop. Does not call it.
    [[nodiscard]] bool was_raised() const { return raised_.load(std::memory_order_relaxed); }

  private:
    using Clock = std::chrono::steady_clock;
    static constexpr Clock::duration kBetween =
        std::chrono::duration_cast<Clock::duration>(std::chrono::milliseconds(5));

    StopCallback should_stop_;
    void* user_;
    std::atomic<bool> raised_{false};
    std::atomic<std::int64_t> next_{0};
    std::atomic_flag asking_ = ATOMIC_FLAG_INIT;
};

// A part of a long operation, which asks the whole's callback: from one share of the whole to another.
struct PartOfStop {
    StopCallback should_stop;  // nullptr: it is not asked
    void* user;
    double from, to;

    [[nodiscard]] static bool ask(void* part, double share_done) {
        const PartOfStop& its = *static_cast<const PartOfStop*>(part);
        return its.should_stop != nullptr && its.should_stop(its.user, its.from + (its.to - its.from) * share_done);
    }
};

}  // namespace crofton::detail
