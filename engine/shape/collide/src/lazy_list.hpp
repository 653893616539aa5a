// SPDX-License-Identifier: MIT
// A list that is built when it is first read.
#pragma once
#include <atomic>
#include <crofton/core/memory.hpp>
#include <mutex>
#include <span>

namespace crofton::collide {

// One thread calls forget(), any may ask between these calls.
template <class T>
class LazyList {
  public:
    void forget() { is_made_ = false; }
    template <class Make>
    [[nodiscard]] std::span<const T> get(Make make) {
        if (!is_made_.load(std::memory_order_acquire)) {
            const std::lock_guard lock(mutex_);
            if (!is_made_.load(std::memory_order_relaxed)) make(values_);
            is_made_.store(true, std::memory_order_release);
        }
        return values_;
    }

  private:
    std::mutex mutex_;
    std::atomic<bool> is_made_ = false;
    Vector<T> values_;
};

}  // namespace crofton::collide
