// SPDX-License-Identifier: MIT
// Exact sums and products of doubles, for signs that floating-point filters cannot decide.
#pragma once
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace crofton {

// A real number as the exact sum of up to N doubles that do not overlap, smallest first; zeros are dropped. Source:
// Shewchuk, "Adaptive precision floating-point arithmetic", 1997. Exact as long as no partial product over- or
// underflows: every nonzero product of inputs, and 2^-53 of it, must lie within [1e-300, 1e300]. Sizes are bounds known
// at compile time, so nothing is allocated.
template <std::size_t N>
struct Expansion {
    std::array<double, N> terms;
    std::size_t count = 0;

    void push(double term) {
        if (term != 0.0) terms[count++] = term;
    }
    // −1, 0 or +1: the largest term outweighs all others together.
    [[nodiscard]] int sign() const { return count == 0 ? 0 : (terms[count - 1] > 0.0 ? 1 : -1); }
    // Within one part in 2^52 of the exact value.
    [[nodiscard]] double estimate() const {
        double sum = 0.0;
        for (std::size_t i = 0; i < count; ++i) sum += terms[i];
        return sum;
    }
};

namespace detail {

struct TwoTerms {
    double high, low;
};

// a + b = high + low, exactly (Knuth).
[[nodiscard]] inline TwoTerms two_sum(double a, double b) {
    const double high = a + b;
    const double b_part = high - a;
    const double a_part = high - b_part;
    return {high, (a - a_part) + (b - b_part)};
}

// The nearest number of 26 bits; what is left has as many.
[[nodiscard]] inline double upper_half(double value) {
    constexpr std::uint64_t kUnit = std::uint64_t{1} << 27;
    return std::bit_cast<double>((std::bit_cast<std::uint64_t>(value) + kUnit / 2) & ~(kUnit - 1));
}

// The same without fused multiplication (Dekker): all products of halves are exact.
[[nodiscard]] inline TwoTerms two_product_of_halves(double a, double b) {
    const double high = a * b, a1 = upper_half(a), b1 = upper_half(b), a2 = a - a1, b2 = b - b1;
    return {high, ((a1 * b1 - high) + a1 * b2 + a2 * b1) + a2 * b2};
}

// a · b = high + low, exactly. MinGW's std::fma rounds twice.
[[nodiscard]] inline TwoTerms two_product(double a, double b) {
#if defined(__MINGW32__) && !defined(__FMA__)
    return two_product_of_halves(a, b);
#else
    const double high = a * b;
    return {high, std::fma(a, b, -high)};
#endif
}

}  // namespace detail

[[nodiscard]] inline Expansion<1> exact(double value) {
    Expansion<1> result;
    result.push(value);
    return result;
}

[[nodiscard]] inline Expansion<2> exact_sum(double a, double b) {
    const auto [high, low] = detail::two_sum(a, b);
    Expansion<2> result;
    result.push(low);
    result.push(high);
    return result;
}

[[nodiscard]] inline Expansion<2> exact_difference(double a, double b) {
    return exact_sum(a, -b);
}

[[nodiscard]] inline Expansion<2> exact_product(double a, double b) {
    const auto [high, low] = detail::two_product(a, b);
    Expansion<2> result;
    result.push(low);
    result.push(high);
    return result;
}

template <std::size_t N>
[[nodiscard]] Expansion<N> operator-(Expansion<N> e) {
    for (std::size_t i = 0; i < e.count; ++i) e.terms[i] = -e.terms[i];
    return e;
}

// Merge by magnitude, then one pass of two_sum (Shewchuk's linear-expansion-sum needs round-to-even; so does this).
template <std::size_t N, std::size_t M>
[[nodiscard]] Expansion<N + M> operator+(const Expansion<N>& a, const Expansion<M>& b) {
    Expansion<N + M> result;
    std::size_t i = 0, j = 0;
    const auto next = [&] {
        const bool take_a = j == b.count || (i < a.count && std::fabs(a.terms[i]) < std::fabs(b.terms[j]));
        return take_a ? a.terms[i++] : b.terms[j++];
    };
    if (a.count + b.count == 0) return result;
    double carry = next();
    while (i < a.count || j < b.count) {
        const auto [high, low] = detail::two_sum(carry, next());
        result.push(low);
        carry = high;
    }
    result.push(carry);
    return result;
}

template <std::size_t N, std::size_t M>
[[nodiscard]] Expansion<N + M> operator-(const Expansion<N>& a, const Expansion<M>& b) {
    return a + (-b);
}

// e · factor, exactly (Shewchuk's scale-expansion with zero elimination).
template <std::size_t N>
[[nodiscard]] Expansion<2 * N> operator*(const Expansion<N>& e, double factor) {
    Expansion<2 * N> result;
    if (e.count == 0 || factor == 0.0) return result;
    auto [carry, first_low] = detail::two_product(e.terms[0], factor);
    result.push(first_low);
    for (std::size_t i = 1; i < e.count; ++i) {
        const auto product = detail::two_product(e.terms[i], factor);
        const auto low_sum = detail::two_sum(carry, product.low);
        result.push(low_sum.low);
        const auto high_sum = detail::two_sum(product.high, low_sum.high);
        result.push(high_sum.low);
        carry = high_sum.high;
    }
    result.push(carry);
    return result;
}

template <std::size_t N, std::size_t M>
[[nodiscard]] Expansion<2 * N * M> operator*(const Expansion<N>& a, const Expansion<M>& b) {
    Expansion<2 * N * M> result;
    for (std::size_t j = 0; j < b.count; ++j) {
        const Expansion<2 * N> row = a * b.terms[j];
        Expansion<2 * N * M> sum;
        // Fits: after j+1 rows the exact sum has at most 2N(j+1) terms.
        const auto wide = result + row;
        for (std::size_t i = 0; i < wide.count; ++i) sum.push(wide.terms[i]);
        result = sum;
    }
    return result;
}

}  // namespace crofton
