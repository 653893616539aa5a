// SPDX-License-Identifier: MIT
// Powers without the C library, whose last bits differ between machines.
#pragma once
#include <cmath>

namespace crofton::cull {

// base^exponent for base > 0 and 0 ≤ exponent ≤ 1, by square roots: bit by bit of the exponent.
[[nodiscard]] inline double power(double base, double exponent) {
    if (exponent >= 1.0) return base;
    double result = 1.0;
    for (int bit = 0; bit < 52 && exponent > 0.0; ++bit) {
        base = std::sqrt(base);
        exponent *= 2.0;
        if (exponent >= 1.0) {
            result *= base;
            exponent -= 1.0;
        }
    }
    return result;
}

}  // namespace crofton::cull
