// SPDX-License-Identifier: MIT
// Sixteen rectangles around points at once, compiled for each instruction set and chosen at run time.
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include <hwy/highway.h>

#include "least_rectangle.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::mesh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

std::size_t LeastRectangle(const float* u, const float* v, std::size_t count, const Angles& angles) {
    const hn::CappedTag<float, kAngles> d;
    alignas(64) float perimeter[kAngles];
    for (std::size_t l = 0; l < kAngles; l += hn::Lanes(d)) {
        const auto c = hn::Load(d, angles.cosine + l), s = hn::Load(d, angles.sine + l);
        auto low_x = hn::Set(d, 3e38f), high_x = hn::Neg(low_x), low_y = low_x, high_y = high_x;
        for (std::size_t i = 0; i < count; ++i) {
            const auto p = hn::Set(d, u[i]), q = hn::Set(d, v[i]);
            const auto x = hn::Add(hn::Mul(c, p), hn::Mul(s, q)), y = hn::Sub(hn::Mul(c, q), hn::Mul(s, p));
            low_x = hn::Min(low_x, x);
            high_x = hn::Max(high_x, x);
            low_y = hn::Min(low_y, y);
            high_y = hn::Max(high_y, y);
        }
        hn::Store(hn::Add(hn::Sub(high_x, low_x), hn::Sub(high_y, low_y)), d, perimeter + l);
    }
    std::size_t best = 0;
    for (std::size_t i = 1; i < kAngles; ++i)
        if (perimeter[i] < perimeter[best]) best = i;
    return best;
}

}  // namespace crofton::mesh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::mesh {

HWY_EXPORT(LeastRectangle);

std::size_t least_rectangle(const float* u, const float* v, std::size_t count, const Angles& angles) {
    return HWY_DYNAMIC_DISPATCH(LeastRectangle)(u, v, count, angles);
}

}  // namespace crofton::mesh
#endif
