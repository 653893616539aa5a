// SPDX-License-Identifier: MIT
// Four floats side by side, of which three are the components or axes of a box; the last is anything. The compilers'
// own vectors: operations are single roundings on every machine.
#pragma once
#include <cstring>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace crofton::collide {

using Lanes4 = float __attribute__((vector_size(16)));
using Bits4 = int __attribute__((vector_size(16)));

// Four floats from memory; the last belongs to what comes after.
[[nodiscard]] inline Lanes4 load4(const char* from) {
    Lanes4 lanes;
    std::memcpy(&lanes, from, sizeof lanes);
    return lanes;
}

[[nodiscard]] inline Lanes4 all_lanes(float value) {
    return Lanes4{value, value, value, value};
}

[[nodiscard]] inline Lanes4 magnitude(Lanes4 v) {
    constexpr int kAllButSign = 0x7fffffff;
    return reinterpret_cast<Lanes4>(reinterpret_cast<Bits4>(v) &
                                    Bits4{kAllButSign, kAllButSign, kAllButSign, kAllButSign});
}

// b where either is NaN.
[[nodiscard]] inline Lanes4 larger(Lanes4 a, Lanes4 b) {
    return a > b ? a : b;
}

// Lane j of the result is lane j + 1, or j + 2, of the first three, in a circle.
[[nodiscard]] inline Lanes4 next(Lanes4 v) {
    return __builtin_shufflevector(v, v, 1, 2, 0, 3);
}
[[nodiscard]] inline Lanes4 after_next(Lanes4 v) {
    return __builtin_shufflevector(v, v, 2, 0, 1, 3);
}

// Rows x, y, z of the matrix whose columns are the first three lanes of a, b, c.
inline void transpose(Lanes4 a, Lanes4 b, Lanes4 c, Lanes4& x, Lanes4& y, Lanes4& z) {
    const Lanes4 low = __builtin_shufflevector(a, b, 0, 4, 1, 5);   // ax bx ay by
    const Lanes4 high = __builtin_shufflevector(a, b, 2, 6, 3, 7);  // az bz . .
    x = __builtin_shufflevector(low, c, 0, 1, 4, 4);
    y = __builtin_shufflevector(low, c, 2, 3, 5, 5);
    z = __builtin_shufflevector(high, c, 0, 1, 6, 6);
}

// Bit j for lane j of a comparison, of the first three.
[[nodiscard]] inline unsigned lanes_where(Bits4 comparison) {
#if defined(__SSE2__)
    return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(comparison))) & 7u;
#else
    return (comparison[0] != 0 ? 1u : 0u) | (comparison[1] != 0 ? 2u : 0u) | (comparison[2] != 0 ? 4u : 0u);
#endif
}

}  // namespace crofton::collide
