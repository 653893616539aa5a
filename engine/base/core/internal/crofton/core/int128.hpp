// SPDX-License-Identifier: MIT
// Integers of 128 bits: the compiler's, or two words where it has none. All operations are modulo 2^128.
#pragma once
#include <concepts>
#include <crofton/core/extensions.hpp>
#include <cstdint>

namespace crofton {
namespace portable {

// The full product of two words.
struct WordProduct {
    std::uint64_t low, high;
    constexpr WordProduct(std::uint64_t a, std::uint64_t b) : low(a * b), high(0) {
        const std::uint64_t a0 = a & 0xffffffffu, a1 = a >> 32, b0 = b & 0xffffffffu, b1 = b >> 32;
        const std::uint64_t middle = a1 * b0 + (a0 * b0 >> 32);
        const std::uint64_t other = a0 * b1 + (middle & 0xffffffffu);
        high = a1 * b1 + (middle >> 32) + (other >> 32);
    }
};

// low + high · 2^64; signed ones in two's complement.
template <bool Signed>
struct TwoWords {
    std::uint64_t low = 0, high = 0;

    constexpr TwoWords() = default;
    template <std::integral Number>
    constexpr TwoWords(Number number)
        : low(static_cast<std::uint64_t>(number)), high(number < Number{0} ? ~std::uint64_t{0} : 0) {}
    constexpr TwoWords(std::uint64_t low_word, std::uint64_t high_word) : low(low_word), high(high_word) {}
    constexpr explicit TwoWords(const TwoWords<!Signed>& other) : low(other.low), high(other.high) {}
    constexpr explicit operator std::uint64_t() const { return low; }
    constexpr explicit operator std::int64_t() const { return static_cast<std::int64_t>(low); }

    friend constexpr TwoWords operator+(const TwoWords& a, const TwoWords& b) {
        const std::uint64_t sum = a.low + b.low;
        return {sum, a.high + b.high + (sum < a.low ? 1u : 0u)};
    }
    friend constexpr TwoWords operator~(const TwoWords& a) { return {~a.low, ~a.high}; }
    friend constexpr TwoWords operator-(const TwoWords& a, const TwoWords& b) { return a + ~b + TwoWords(1); }
    friend constexpr TwoWords operator|(const TwoWords& a, const TwoWords& b) {
        return {a.low | b.low, a.high | b.high};
    }
    friend constexpr TwoWords operator*(const TwoWords& a, const TwoWords& b) {
        const WordProduct product(a.low, b.low);
        return {product.low, product.high + a.low * b.high + a.high * b.low};
    }
    friend constexpr bool operator==(const TwoWords&, const TwoWords&) = default;
    friend constexpr bool operator<(const TwoWords& a, const TwoWords& b) {
        constexpr std::uint64_t kSign = Signed ? std::uint64_t{1} << 63 : 0;
        return a.high != b.high ? (a.high ^ kSign) < (b.high ^ kSign) : a.low < b.low;
    }
};

using Int128 = TwoWords<true>;
using Uint128 = TwoWords<false>;

[[nodiscard]] constexpr std::uint64_t high_word(const Uint128& a) {
    return a.high;
}
[[nodiscard]] constexpr std::int64_t high_word(const Int128& a) {
    return static_cast<std::int64_t>(a.high);
}

}  // namespace portable

#if defined(CROFTON_COMPILER_INT128)
__extension__ typedef __int128 Int128;
__extension__ typedef unsigned __int128 Uint128;

[[nodiscard]] constexpr std::uint64_t high_word(Uint128 a) {
    return static_cast<std::uint64_t>(a >> 64);
}
[[nodiscard]] constexpr std::int64_t high_word(Int128 a) {
    return static_cast<std::int64_t>(a >> 64);
}
[[nodiscard]] constexpr Uint128 of_words(std::uint64_t low, std::uint64_t high) {
    return Uint128{high} << 64 | low;
}
#else
using portable::high_word, portable::Int128, portable::Uint128;

[[nodiscard]] constexpr Uint128 of_words(std::uint64_t low, std::uint64_t high) {
    return {low, high};
}
#endif

}  // namespace crofton
