// SPDX-License-Identifier: MIT
// Boxes as the builder of hierarchies takes them: four floats at a time, the fourth of which is never read.
#pragma once
#include <crofton/core/extensions.hpp>
#include <cstdint>
#include <limits>

namespace crofton::mesh {

#if defined(CROFTON_COMPILER_VECTORS)
// The compilers' own vectors: operations are single roundings on every machine.
using Four = float __attribute__((vector_size(16)));

// b where either is NaN.
[[nodiscard]] inline Four lesser(Four a, Four b) {
    return a < b ? a : b;
}
[[nodiscard]] inline Four larger(Four a, Four b) {
    return a > b ? a : b;
}
// Towards 0. Requires numbers that fit.
inline void to_integers(Four a, std::int32_t (&out)[4]) {
    for (int k = 0; k < 4; ++k) out[k] = static_cast<std::int32_t>(a[k]);
}
#else
struct alignas(16) Four {
    float lane[4];
    float& operator[](int k) { return lane[k]; }
    float operator[](int k) const { return lane[k]; }
};
template <class Operation>
[[nodiscard]] inline Four each(const Four& a, const Four& b, Operation operation) {
    return {{operation(a[0], b[0]), operation(a[1], b[1]), operation(a[2], b[2]), operation(a[3], b[3])}};
}
[[nodiscard]] inline Four operator+(const Four& a, const Four& b) {
    return each(a, b, [](float x, float y) { return x + y; });
}
[[nodiscard]] inline Four operator-(const Four& a, const Four& b) {
    return each(a, b, [](float x, float y) { return x - y; });
}
[[nodiscard]] inline Four operator*(const Four& a, const Four& b) {
    return each(a, b, [](float x, float y) { return x * y; });
}
[[nodiscard]] inline Four lesser(const Four& a, const Four& b) {
    return each(a, b, [](float x, float y) { return x < y ? x : y; });
}
[[nodiscard]] inline Four larger(const Four& a, const Four& b) {
    return each(a, b, [](float x, float y) { return x > y ? x : y; });
}
inline void to_integers(const Four& a, std::int32_t (&out)[4]) {
    for (int k = 0; k < 4; ++k) out[k] = static_cast<std::int32_t>(a[k]);
}
#endif

[[nodiscard]] inline Four four(float x) {
    return Four{x, x, x, x};
}

struct WideBox {
    Four low = four(std::numeric_limits<float>::infinity()), high = four(-std::numeric_limits<float>::infinity());

    void include(const Four& low_corner, const Four& high_corner) {
        low = lesser(low_corner, low);
        high = larger(high_corner, high);
    }
    void include(const WideBox& box) { include(box.low, box.high); }
    [[nodiscard]] Four middle() const { return four(0.5f) * low + four(0.5f) * high; }
};

// 0 of an empty box.
[[nodiscard]] inline double half_area(const WideBox& box) {
    double d[3];
    for (int k = 0; k < 3; ++k) d[k] = static_cast<double>(box.high[k]) - static_cast<double>(box.low[k]);
    return d[0] >= 0.0 ? d[0] * d[1] + d[1] * d[2] + d[2] * d[0] : 0.0;
}

}  // namespace crofton::mesh
