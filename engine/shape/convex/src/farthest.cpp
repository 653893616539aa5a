// SPDX-License-Identifier: MIT
// The farthest of many points along a direction, compiled for each instruction set and chosen at run time.
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include <hwy/highway.h>
#include <crofton/simd/mask_bits-inl.hpp>

#include "support.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::convex::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace simd = crofton::simd::HWY_NAMESPACE;

// Each value is that of farthest_of(), by the same roundings, so the point is the same.
int Farthest(const double* x, const double* y, const double* z, int count, const glm::dvec3& direction, double& most) {
    const hn::CappedTag<double, 4> d;
    const int lanes = static_cast<int>(hn::Lanes(d));
    HWY_ALIGN double along[3 * kMaxHullVertices];
    const auto dx = hn::Set(d, direction.x), dy = hn::Set(d, direction.y), dz = hn::Set(d, direction.z);
    const auto value = [&](int i) {
        const auto v = hn::Add(hn::Add(hn::Mul(dx, hn::LoadU(d, x + i)), hn::Mul(dy, hn::LoadU(d, y + i))),
                               hn::Mul(dz, hn::LoadU(d, z + i)));
        hn::Store(v, d, along + i);
        return v;
    };
    auto even = value(0), odd = even;
    int i = lanes;
    for (; i + lanes < count; i += 2 * lanes) {
        odd = hn::Max(value(i), odd);
        even = hn::Max(value(i + lanes), even);
    }
    if (i < count) odd = hn::Max(value(i), odd);
    const auto high = hn::MaxOfLanes(d, hn::Max(odd, even));
    most = hn::GetLane(high) + 0.0;
    for (i = 0; i < count; i += lanes)
        if (const std::uint32_t equal = simd::mask_bits(d, hn::Eq(hn::Load(d, along + i), high)); equal != 0)
            return i + static_cast<int>(hwy::Num0BitsBelowLS1Bit_Nonzero32(equal));
    return 0;
}

}  // namespace crofton::convex::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::convex {

HWY_EXPORT(Farthest);

int farthest_of_many(const double* x, const double* y, const double* z, int count, const glm::dvec3& d, double& most) {
    return HWY_DYNAMIC_DISPATCH(Farthest)(x, y, z, count, d, most);
}

}  // namespace crofton::convex
#endif
