// SPDX-License-Identifier: MIT
// Sums of lengths to about 100 bits.
#pragma once
#include <cmath>
#include <crofton/geometry/expansion.hpp>
#include <glm/vec2.hpp>

namespace crofton::triangulate {

// high + low, where low is at most half a unit in the last place of high. Adding two of equal sign errs by at most
// 2^-104 of the sum.
struct DoubleDouble {
    double high = 0.0, low = 0.0;
    void add(double h, double l) {
        const auto sum = detail::two_sum(high, h);
        const auto renormalised = detail::two_sum(sum.high, sum.low + low + l);
        high = renormalised.high;
        low = renormalised.low;
    }
};

// A squared length: high + rest within 2^-104 of it, exactly if `exact`.
struct SquaredLength {
    double high, rest;
    bool exact;
};
[[nodiscard]] inline SquaredLength squared_length(const glm::dvec2& a, const glm::dvec2& b) {
    const auto x = detail::two_sum(a.x, -b.x), y = detail::two_sum(a.y, -b.y);
    const auto xx = detail::two_product(x.high, x.high), yy = detail::two_product(y.high, y.high);
    const auto sum = detail::two_sum(xx.high, yy.high);
    const bool exact = x.low == 0.0 && y.low == 0.0 && xx.low == 0.0 && yy.low == 0.0;
    return {sum.high, sum.low + (xx.low + yy.low + 2.0 * (x.high * x.low + y.high * y.low)), exact};
}

// √(s + r) = q + (s − q² + r) / 2q with q = √s rounded: the neglected term is below q·2^-104, as are the roundings of
// the correction. In all it errs by less than q·2^-101.
[[nodiscard]] inline DoubleDouble root(const SquaredLength& square) {
    const double q = std::sqrt(square.high);
    const auto qq = detail::two_product(q, q);
    return {q, (((square.high - qq.high) - qq.low) + square.rest) / (2.0 * q)};
}

}  // namespace crofton::triangulate
