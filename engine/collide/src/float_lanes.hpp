// Four floats side by side, of which three are the components or axes of a box. The compilers' own vectors: operations
// are single roundings on every machine.
#pragma once
#include <cstring>

namespace crofton::collide {

using Lanes4 = float __attribute__((vector_size(16)));
using Bits4 = int __attribute__((vector_size(16)));

// Four floats from memory; the last belongs to what comes after.
[[nodiscard]] inline Lanes4 load4(const char* from) {
    Lanes4 lanes;
    std::memcpy(&lanes, from, sizeof lanes);
    return lanes;
}

[[nodiscard]] inline Lanes4 magnitude(Lanes4 v) {
    constexpr int kAllButSign = 0x7fffffff;
    return reinterpret_cast<Lanes4>(reinterpret_cast<Bits4>(v) &
                                    Bits4{kAllButSign, kAllButSign, kAllButSign, kAllButSign});
}

[[nodiscard]] inline Lanes4 larger(Lanes4 a, Lanes4 b) {
    return a > b ? a : b;
}
[[nodiscard]] inline Lanes4 smaller(Lanes4 a, Lanes4 b) {
    return a < b ? a : b;
}

// Lane j of the result is lane j + 1, or j + 2, of the first three, in a circle.
[[nodiscard]] inline Lanes4 next(Lanes4 v) {
    return __builtin_shufflevector(v, v, 1, 2, 0, 3);
}
[[nodiscard]] inline Lanes4 after_next(Lanes4 v) {
    return __builtin_shufflevector(v, v, 2, 0, 1, 3);
}

// Rows x, y, z of the matrix whose columns are the first three lanes of a, b, c; their last lane is zero.
inline void transpose(Lanes4 a, Lanes4 b, Lanes4 c, Lanes4& x, Lanes4& y, Lanes4& z) {
    const Lanes4 zero = {};
    const Lanes4 low = __builtin_shufflevector(a, b, 0, 4, 1, 5);        // ax bx ay by
    const Lanes4 high = __builtin_shufflevector(a, b, 2, 6, 3, 7);       // az bz . .
    const Lanes4 c_low = __builtin_shufflevector(c, zero, 0, 4, 1, 5);   // cx 0 cy 0
    const Lanes4 c_high = __builtin_shufflevector(c, zero, 2, 6, 2, 6);  // cz 0 . .
    x = __builtin_shufflevector(low, c_low, 0, 1, 4, 5);
    y = __builtin_shufflevector(low, c_low, 2, 3, 6, 7);
    z = __builtin_shufflevector(high, c_high, 0, 1, 4, 5);
}

[[nodiscard]] inline float sum3(Lanes4 v) {
    return v[0] + v[1] + v[2];
}
[[nodiscard]] inline float largest3(Lanes4 v) {
    const float low = v[0] > v[1] ? v[0] : v[1];
    return low > v[2] ? low : v[2];
}

}  // namespace crofton::collide
