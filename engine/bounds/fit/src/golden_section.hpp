// SPDX-License-Identifier: MIT
#pragma once

namespace crofton::fit {

// Returns where between low and high f is least, by golden sections: of an f that falls and then rises, within
// 0.618^steps of the range.
template <class Function>
double minimise(double low, double high, int steps, Function f) {
    constexpr double kGolden = 0.61803398874989485;
    double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
    double at_a = f(a), at_b = f(b);
    for (int i = 0; i < steps; ++i) {
        if (at_a < at_b) {
            high = b, b = a, at_b = at_a;
            a = high - kGolden * (high - low), at_a = f(a);
        } else {
            low = a, a = b, at_a = at_b;
            b = low + kGolden * (high - low), at_b = f(b);
        }
    }
    return at_a < at_b ? a : b;
}

}  // namespace crofton::fit
