// SPDX-License-Identifier: MIT
// How much a file may ask for: what a reader refuses before it takes the memory or the time.
#pragma once
#include <algorithm>
#include <chrono>
#include <crofton/core/error.hpp>
#include <cstdint>
#include <string>

namespace crofton::assets {

// The defaults keep a small hostile file below 1 GB of memory. An error names the limit and, but for nesting, the
// option that raises it.
struct ReadLimits {
    std::uint64_t bytes = std::uint64_t{1} << 30;      // of a file with all that it refers to
    std::uint64_t triangles = std::uint64_t{1} << 23;  // of all meshes; vertices may be three times as many
    std::uint64_t pixels = std::uint64_t{1} << 26;     // of one image as it is decoded, and of all as they are kept
    std::uint64_t nodes = std::uint64_t{1} << 20;      // nodes or instances; a JSON text may have 16 values for each
    std::uint32_t nesting = 200;                       // arrays and objects in each other; what reads them recurses
    double seconds = 600.0;
};

[[nodiscard]] inline Error over_limit(const char* what, std::uint64_t limit) {
    return fail(ErrorCode::budget_exceeded, kNoItem,
                "more than " + std::to_string(limit) + " " + what + ", the limit: --max-" + what + " raises it");
}

// The seconds of a ReadLimits, from when it is made.
class Deadline {
  public:
    explicit Deadline(const ReadLimits& limits) : seconds_(limits.seconds) {}

    [[nodiscard]] Result<void> check() const {
        const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start_;
        if (passed.count() <= seconds_) return {};
        return over_limit("seconds", static_cast<std::uint64_t>(std::max(seconds_, 0.0)));
    }

  private:
    double seconds_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace crofton::assets
