// SPDX-License-Identifier: MIT
// Vectors of up to sixteen floats, points and ranges: shared by the kernels of small sets.
#if defined(CROFTON_FIT_SMALL_SET_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_FIT_SMALL_SET_LANES_INL
#undef CROFTON_FIT_SMALL_SET_LANES_INL
#else
#define CROFTON_FIT_SMALL_SET_LANES_INL
#endif

#include <hwy/highway.h>

#include "small_set/kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::fit::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr float kHuge = 1e30f;

using Tag = hn::CappedTag<float, kLanes>;
using Lane = hn::Vec<Tag>;

struct Vec3 {
    Lane x, y, z;
};

HWY_INLINE Vec3 set(Tag d, const float v[3]) {
    return {hn::Set(d, v[0]), hn::Set(d, v[1]), hn::Set(d, v[2])};
}
HWY_INLINE Lane dot(const Vec3& a, const Vec3& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vec3 cross(const Vec3& a, const Vec3& b) {
    return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
            hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE Vec3 scaled(const Vec3& a, Lane s) {
    return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)};
}
HWY_INLINE Vec3 broadcast(Tag d, const SmallSet& points, std::size_t i) {
    return {hn::Set(d, points.x[i]), hn::Set(d, points.y[i]), hn::Set(d, points.z[i])};
}

HWY_INLINE Vec3 load(Tag d, const SmallSet& points, std::size_t i) {
    return {hn::LoadU(d, points.x + i), hn::LoadU(d, points.y + i), hn::LoadU(d, points.z + i)};
}

struct Range {
    Lane low, high;

    HWY_INLINE void include(Lane t) {
        low = hn::Min(low, t);
        high = hn::Max(high, t);
    }
    [[nodiscard]] HWY_INLINE Lane width() const { return hn::Sub(high, low); }
};
HWY_INLINE Range nothing(Tag d) {
    return {hn::Set(d, kHuge), hn::Set(d, -kHuge)};
}

HWY_INLINE Lane value(Tag d, const FloatWeights& w, Lane a, Lane b, Lane c) {
    const auto ab = hn::Mul(a, b), a_plus_b = hn::Add(a, b);
    const auto product = hn::Mul(hn::Set(d, w.product), hn::Mul(ab, c));
    const auto pairs = hn::Mul(hn::Set(d, w.pairs), hn::Add(ab, hn::Mul(a_plus_b, c)));
    return hn::Add(hn::Add(product, pairs), hn::Mul(hn::Set(d, w.sum), hn::Add(a_plus_b, c)));
}

HWY_INLINE Lane value_in_frame(Tag d, const SmallSet& points, const FloatWeights& weights, const Vec3& a, const Vec3& b,
                               const Vec3& c) {
    Range along_a = nothing(d), along_b = along_a, along_c = along_a;
    for (std::size_t i = 0; i < points.count; ++i) {
        const Vec3 p = broadcast(d, points, i);
        along_a.include(dot(a, p));
        along_b.include(dot(b, p));
        along_c.include(dot(c, p));
    }
    return value(d, weights, along_a.width(), along_b.width(), along_c.width());
}

}  // namespace crofton::fit::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
