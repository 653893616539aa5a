// SPDX-License-Identifier: MIT
#include "integer_axis.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/core/int128.hpp>
#include <crofton/geometry/expansion.hpp>
#include <crofton/geometry/float_lanes.hpp>
#include <cstddef>

#include "careful_axis.hpp"

namespace crofton::collide {

using detail::all_lanes, detail::Bits4, detail::Lanes4, detail::lanes_where, detail::larger, detail::load4,
    detail::magnitude, detail::next;

namespace {

constexpr int kAxisBits = 48, kSizeBits = 61;

// low + high · 2^64
struct Int192 {
    std::uint64_t low = 0;
    Int128 high = 0;
};

Int192 operator+(const Int192& a, const Int192& b) {
    const std::uint64_t low = a.low + b.low;
    return {low, a.high + b.high + (low < a.low ? 1 : 0)};
}

Int192 product(Int128 a, std::int64_t b) {
    const auto low = static_cast<std::uint64_t>(a);
    const std::int64_t high = high_word(a);
    const Uint128 part = Uint128{low} * static_cast<std::uint64_t>(b);  // of b + 2^64 where b is negative
    const Int128 carry = Int128{high_word(part)} - (b < 0 ? Int128{low} : Int128{0});
    return {static_cast<std::uint64_t>(part), Int128{high} * b + carry};
}

Int192 absolute(const Int192& a) {
    if (high_word(a.high) >= 0) return a;
    const std::uint64_t low = ~a.low + 1;
    return {low, ~a.high + (low == 0 ? 1 : 0)};
}

// low + high · 2^128
struct Int256 {
    Uint128 low = 0;
    Int128 high = 0;
};

// Of a that is not negative.
Int256 scaled(const Int192& a, std::uint64_t factor) {
    const Uint128 low = Uint128{a.low} * factor;
    const Uint128 middle = Uint128{static_cast<std::uint64_t>(a.high)} * factor + high_word(low);
    const Uint128 high = Uint128{static_cast<std::uint64_t>(high_word(a.high))} * factor + high_word(middle);
    return {of_words(static_cast<std::uint64_t>(low), static_cast<std::uint64_t>(middle)), static_cast<Int128>(high)};
}

Int256 operator+(const Int256& a, const Int256& b) {
    const Uint128 low = a.low + b.low;
    return {low, a.high + b.high + (low < a.low ? 1 : 0)};
}

// Each of the three terms has at most 99 + 62 bits.
Int192 dot(const Int128 (&u)[3], const std::int64_t (&v)[3]) {
    return product(u[0], v[0]) + product(u[1], v[1]) + product(u[2], v[2]);
}

// value · scale, which is less than 2^62; `fits` becomes false where that is no integer.
std::int64_t integer(double value, double scale, bool& fits) {
    const double scaled = value * scale;
    const auto result = static_cast<std::int64_t>(scaled);
    fits = fits && static_cast<double>(result) == scaled;
    return result;
}

// 2^bits / the least power of two above value, which is at least 2^-900 and at most 2^900.
double scale_to_bits(double value, int bits) {
    const auto exponent = static_cast<std::int64_t>(std::bit_cast<std::uint64_t>(value) >> 52) - 1022;
    return std::bit_cast<double>(static_cast<std::uint64_t>(1023 + bits - exponent) << 52);
}

// Two boxes: edges 0-2 are the axes of a, 3-5 those of b.
struct Integers {
    std::int64_t edge[6][3];
    std::uint64_t half[6];
    std::int64_t offset[3];
    int first[6];  // of the edges that are this one or its opposite, the first

    [[nodiscard]] bool set(const Obb& a, const Obb& b, const PairColumns& columns);
    [[nodiscard]] bool separates(int p, int q) const;
};

bool Integers::set(const Obb& a, const Obb& b, const PairColumns& columns) {
    const auto column = [](const float* from) { return load4(reinterpret_cast<const char*>(from)); };
    Lanes4 u[3], v[3], longest = {};
    for (int c = 0; c < 3; ++c) {
        u[c] = column(columns.a[c]);
        v[c] = column(columns.b[c]);
        longest = larger(longest, larger(magnitude(u[c]), magnitude(v[c])));
    }
    for (int k = 0; k < 6; ++k) first[k] = k;
    for (int shift = 0; shift < 3; ++shift) {
        const Bits4 equal = (u[0] == v[0]) & (u[1] == v[1]) & (u[2] == v[2]);
        const Bits4 opposite = (u[0] == -v[0]) & (u[1] == -v[1]) & (u[2] == -v[2]);
        for (unsigned lanes = lanes_where(equal | opposite); lanes != 0; lanes &= lanes - 1) {
            const int i = std::countr_zero(lanes);
            first[3 + (i + shift) % 3] = i;
        }
        for (Lanes4& x : v) x = next(x);
    }
    double largest = 0.0;
    for (std::size_t i = 0; i < 3; ++i)
        largest = std::max({largest, std::abs(columns.offset[i]),
                            static_cast<double>(std::max(columns.half_a[i], columns.half_b[i]))});
    if (lanes_where(longest < all_lanes(2.0f)) != 7u || !(largest > 0x1p-900)) return false;
    const double scale = scale_to_bits(largest, kSizeBits),
                 axis_scale = static_cast<double>(std::int64_t{1} << kAxisBits);
    bool fits = true;
    for (std::size_t k = 0; k < 6; ++k) {
        const float(&axes)[3][4] = k < 3 ? columns.a : columns.b;
        for (std::size_t c = 0; c < 3; ++c) edge[k][c] = integer(static_cast<double>(axes[c][k % 3]), axis_scale, fits);
        // A pointer: GCC 12 with sanitizers indexes the choice between two arrays wrongly.
        const float* halves = k < 3 ? columns.half_a : columns.half_b;
        half[k] = static_cast<std::uint64_t>(integer(static_cast<double>(halves[k % 3]), scale, fits));
    }
    for (int c = 0; c < 3; ++c) {
        const auto [high, low] = detail::two_sum(b.center[c], -a.center[c]);
        offset[c] = integer(high, scale, fits) + integer(low, scale, fits);
    }
    return fits;
}

bool Integers::separates(int p, int q) const {
    const std::int64_t(&u)[3] = edge[p], (&v)[3] = edge[q];
    const auto minor = [&](int i, int j) { return Int128{u[i]} * v[j] - Int128{u[j]} * v[i]; };
    const Int128 n[3] = {minor(1, 2), minor(2, 0), minor(0, 1)};
    // Extents count edges, which are integers in units of 2^-48; the offset is brought to that unit.
    const Int256 distance = scaled(absolute(dot(n, offset)), std::uint64_t{1} << kAxisBits);
    Int256 projected_radius;
    for (int k = 0; k < 6; ++k)
        if (first[k] != first[p] && first[k] != first[q])
            projected_radius = projected_radius + scaled(absolute(dot(n, edge[k])), half[k]);
    return projected_radius.high < distance.high ||
           (distance.high == projected_radius.high && projected_radius.low < distance.low);
}

}  // namespace

int first_separating(const Obb& a, const Obb& b, const PairColumns& columns, std::uint32_t axes) {
    Integers integers;
    if (!integers.set(a, b, columns)) return kTooWide;
    std::uint64_t asked =
        0;  // directions, each once, by the first of their edges: those of crates with one frame are few
    for (; axes != 0; axes &= axes - 1) {
        const int axis = std::countr_zero(axes);
        const auto [p, q] = kGenerators[axis];
        const int i = integers.first[p], j = integers.first[q];
        const std::uint64_t bit = std::uint64_t{1} << (6 * std::min(i, j) + std::max(i, j));
        if (i == j || (asked & bit) != 0) continue;
        asked |= bit;
        if (integers.separates(p, q)) return axis;
    }
    return kNotSeparated;
}

}  // namespace crofton::collide
