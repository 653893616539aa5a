// SPDX-License-Identifier: MIT
// Milliseconds since it was made: by the clock, and of the processor.
#pragma once
#include <chrono>
#include <ctime>

namespace crofton::cli {

class Stopwatch {
  public:
    [[nodiscard]] double milliseconds() const {
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
    }
    [[nodiscard]] double cpu_milliseconds() const {
        return 1e3 * static_cast<double>(std::clock() - cpu_start_) / static_cast<double>(CLOCKS_PER_SEC);
    }

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    std::clock_t cpu_start_ = std::clock();
};

}  // namespace crofton::cli
