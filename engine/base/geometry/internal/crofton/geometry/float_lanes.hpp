// SPDX-License-Identifier: MIT
// Four floats side by side, of which three are the components of a vector or the axes of a box; the last is arbitrary.
// The compilers' own vectors, or arrays where there are none: operations are single roundings on every machine.
#pragma once
#include <bit>
#include <crofton/core/extensions.hpp>
#include <cstring>
#if defined(CROFTON_COMPILER_VECTORS) && defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace crofton::detail {

#if defined(CROFTON_COMPILER_VECTORS)

using Lanes4 = float __attribute__((vector_size(16)));
using Bits4 = int __attribute__((vector_size(16)));

[[nodiscard]] inline Lanes4 magnitude(Lanes4 v) {
    constexpr int kAllButSign = 0x7fffffff;
    return reinterpret_cast<Lanes4>(reinterpret_cast<Bits4>(v) &
                                    Bits4{kAllButSign, kAllButSign, kAllButSign, kAllButSign});
}

// b where either is NaN.
[[nodiscard]] inline Lanes4 lesser(Lanes4 a, Lanes4 b) {
    return a < b ? a : b;
}
[[nodiscard]] inline Lanes4 larger(Lanes4 a, Lanes4 b) {
    return a > b ? a : b;
}

// Lanes A to D of the eight of a and b.
template <int A, int B, int C, int D>
[[nodiscard]] inline Lanes4 shuffled(Lanes4 a, Lanes4 b) {
    return __builtin_shufflevector(a, b, A, B, C, D);
}

// Bit j for lane j of a comparison, of the first three.
[[nodiscard]] inline unsigned lanes_where(Bits4 comparison) {
#if defined(__SSE2__)
    return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(comparison))) & 7u;
#else
    return (comparison[0] != 0 ? 1u : 0u) | (comparison[1] != 0 ? 2u : 0u) | (comparison[2] != 0 ? 4u : 0u);
#endif
}

#else

struct Lanes4 {
    float lane[4];
    float& operator[](int j) { return lane[j]; }
    float operator[](int j) const { return lane[j]; }
};

// Bit j for lane j.
struct Bits4 {
    unsigned bits;
    friend Bits4 operator&(Bits4 a, Bits4 b) { return {a.bits & b.bits}; }
    friend Bits4 operator|(Bits4 a, Bits4 b) { return {a.bits | b.bits}; }
};

template <class Operation>
[[nodiscard]] inline Lanes4 lane_by_lane(const Lanes4& a, const Lanes4& b, Operation operation) {
    return {{operation(a.lane[0], b.lane[0]), operation(a.lane[1], b.lane[1]), operation(a.lane[2], b.lane[2]),
             operation(a.lane[3], b.lane[3])}};
}
template <class Predicate>
[[nodiscard]] inline Bits4 compared(const Lanes4& a, const Lanes4& b, Predicate holds) {
    unsigned bits = 0;
    for (unsigned j = 0; j < 4; ++j) bits |= (holds(a.lane[j], b.lane[j]) ? 1u : 0u) << j;
    return {bits};
}

[[nodiscard]] inline Lanes4 operator+(const Lanes4& a, const Lanes4& b) {
    return lane_by_lane(a, b, [](float x, float y) { return x + y; });
}
[[nodiscard]] inline Lanes4 operator-(const Lanes4& a, const Lanes4& b) {
    return lane_by_lane(a, b, [](float x, float y) { return x - y; });
}
[[nodiscard]] inline Lanes4 operator*(const Lanes4& a, const Lanes4& b) {
    return lane_by_lane(a, b, [](float x, float y) { return x * y; });
}
[[nodiscard]] inline Lanes4 operator-(const Lanes4& a) {
    return lane_by_lane(a, a, [](float x, float) { return -x; });
}
[[nodiscard]] inline Bits4 operator>(const Lanes4& a, const Lanes4& b) {
    return compared(a, b, [](float x, float y) { return x > y; });
}
[[nodiscard]] inline Bits4 operator<(const Lanes4& a, const Lanes4& b) {
    return compared(a, b, [](float x, float y) { return x < y; });
}
[[nodiscard]] inline Bits4 operator==(const Lanes4& a, const Lanes4& b) {
    return compared(a, b, [](float x, float y) { return x == y; });
}

[[nodiscard]] inline Lanes4 magnitude(const Lanes4& v) {
    return lane_by_lane(v, v,
                        [](float x, float) { return std::bit_cast<float>(std::bit_cast<unsigned>(x) & 0x7fffffffu); });
}

// b where either is NaN.
[[nodiscard]] inline Lanes4 lesser(const Lanes4& a, const Lanes4& b) {
    return lane_by_lane(a, b, [](float x, float y) { return x < y ? x : y; });
}
[[nodiscard]] inline Lanes4 larger(const Lanes4& a, const Lanes4& b) {
    return lane_by_lane(a, b, [](float x, float y) { return x > y ? x : y; });
}

// Lanes A to D of the eight of a and b.
template <int A, int B, int C, int D>
[[nodiscard]] inline Lanes4 shuffled(const Lanes4& a, const Lanes4& b) {
    const auto lane = [&](int i) { return i < 4 ? a.lane[i] : b.lane[i - 4]; };
    return {{lane(A), lane(B), lane(C), lane(D)}};
}

// Bit j for lane j of a comparison, of the first three.
[[nodiscard]] inline unsigned lanes_where(Bits4 comparison) {
    return comparison.bits & 7u;
}

#endif

// Four floats from memory; the last belongs to what comes after.
[[nodiscard]] inline Lanes4 load4(const char* from) {
    Lanes4 lanes;
    std::memcpy(&lanes, from, sizeof lanes);
    return lanes;
}

[[nodiscard]] inline Lanes4 all_lanes(float value) {
    return Lanes4{value, value, value, value};
}

// Lane j of the result is lane j + 1, or j + 2, of the first three, in a circle.
[[nodiscard]] inline Lanes4 next(Lanes4 v) {
    return shuffled<1, 2, 0, 3>(v, v);
}
[[nodiscard]] inline Lanes4 after_next(Lanes4 v) {
    return shuffled<2, 0, 1, 3>(v, v);
}

// Rows x, y, z of the matrix whose columns are the first three lanes of a, b, c.
inline void transpose(Lanes4 a, Lanes4 b, Lanes4 c, Lanes4& x, Lanes4& y, Lanes4& z) {
    const Lanes4 low = shuffled<0, 4, 1, 5>(a, b);   // ax bx ay by
    const Lanes4 high = shuffled<2, 6, 3, 7>(a, b);  // az bz . .
    x = shuffled<0, 1, 4, 4>(low, c);
    y = shuffled<2, 3, 5, 5>(low, c);
    z = shuffled<0, 1, 6, 6>(high, c);
}

}  // namespace crofton::detail
