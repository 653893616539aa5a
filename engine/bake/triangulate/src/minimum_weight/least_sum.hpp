// SPDX-License-Identifier: MIT
// The inner loop of interval programmes.
#pragma once
#include <algorithm>
#include <cstddef>
#include <limits>

namespace crofton::triangulate {

// The least a[i] + b[i]; infinity if there is none. Several running minima, so that one addition need not wait for
// another's comparison; the least of doubles is the same in any order.
[[nodiscard]] inline double least_of_sums(const double* a, const double* b, std::size_t count) {
    constexpr std::size_t kLanes = 8;
    double least[kLanes];
    std::fill(least, least + kLanes, std::numeric_limits<double>::infinity());
    std::size_t i = 0;
    for (; i + kLanes <= count; i += kLanes) {
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const double sum = a[i + lane] + b[i + lane];
            least[lane] = sum < least[lane] ? sum : least[lane];
        }
    }
    for (; i < count; ++i) least[0] = std::min(least[0], a[i] + b[i]);
    return *std::min_element(least, least + kLanes);
}

}  // namespace crofton::triangulate
