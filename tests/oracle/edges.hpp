// SPDX-License-Identifier: MIT
// The very edge of an answer, found by bisection: what lies there sits inside a filter's error bound.
#pragma once
#include <cmath>
#include <utility>

namespace crofton::oracle {

// Two neighbouring numbers between `from` and `to` of which holds() is true of the first alone. It is true of `from`,
// and not of `to`.
template <class Number, class Holds>
std::pair<Number, Number> edge_between(Number from, Number to, Holds holds) {
    for (;;) {
        const Number middle = from + Number(0.5) * (to - from);
        if (middle == from || middle == to) return {from, to};
        (holds(middle) ? from : to) = middle;
    }
}

// From a number to the next.
inline double rounding_step(double number) {
    return std::nextafter(std::fabs(number), 1e300) - std::fabs(number);
}

}  // namespace crofton::oracle
