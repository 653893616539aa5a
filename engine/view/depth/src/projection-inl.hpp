// SPDX-License-Identifier: MIT
// Where the boxes of clusters lie in the picture. Compiled once per instruction set (Highway).
#include <hwy/highway.h>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "culler_data.hpp"
#include "tiles-inl.hpp"

#if defined(CROFTON_DEPTH_PROJECTION_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_DEPTH_PROJECTION_INL
#undef CROFTON_DEPTH_PROJECTION_INL
#else
#define CROFTON_DEPTH_PROJECTION_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::depth::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Pixels by which the product with the matrix may move a vertex, at a distance w from the eye, in or near the picture.
HWY_INLINE float pixel_error(const PictureData& picture, const ObjectData& object, float w) {
    const float x = (object.errors[0] + 2.0f * object.errors[3]) * picture.half_width;
    const float y = (object.errors[1] + 2.0f * object.errors[3]) * picture.half_height;
    return std::max(x, y) / w;
}

// Half-open coordinates to the samples within, which lie at halves.
HWY_INLINE std::int32_t first_sample(float low, float limit) {
    return static_cast<std::int32_t>(std::ceil(std::min(std::max(low - 0.5f, 0.0f), limit)));
}
HWY_INLINE std::int32_t last_sample(float high, float limit) {
    return static_cast<std::int32_t>(std::floor(std::min(std::max(high - 0.5f, -1.0f), limit - 1.0f)));
}

HWY_INLINE VF first_samples(VF low, VF limit) {
    const DF d;
    return hn::Ceil(hn::Min(hn::Max(hn::Sub(low, hn::Set(d, 0.5f)), hn::Zero(d)), limit));
}
HWY_INLINE VF last_samples(VF high, VF limit) {
    const DF d;
    const VF one = hn::Set(d, 1.0f);
    return hn::Floor(hn::Min(hn::Max(hn::Sub(high, hn::Set(d, 0.5f)), hn::Neg(one)), hn::Sub(limit, one)));
}

HWY_INLINE Projection project(const PictureData& picture, const ObjectData& object, const Cluster& cluster) {
    const DF d;
    const float* const c = &cluster.center.x;
    float middle[4], edges[3][4];
    for (int i = 0; i < 4; ++i) {
        middle[i] = ((object.columns[0][i] * c[0] + object.columns[1][i] * c[1]) + object.columns[2][i] * c[2]) +
                    object.columns[3][i];
        for (int k = 0; k < 3; ++k) {
            const float* const h = &cluster.half_edges[static_cast<std::size_t>(k)].x;
            edges[k][i] = (object.columns[0][i] * h[0] + object.columns[1][i] * h[1]) + object.columns[2][i] * h[2];
        }
    }
    alignas(32) static constexpr float kSigns[3][8] = {
        {-1, 1, -1, 1, -1, 1, -1, 1}, {-1, -1, 1, 1, -1, -1, 1, 1}, {-1, -1, -1, -1, 1, 1, 1, 1}};
    const float infinity = std::numeric_limits<float>::infinity();
    VF least_w = hn::Set(d, infinity), before_near = hn::Set(d, infinity);
    VF low_x = least_w, high_x = hn::Neg(least_w), low_y = least_w, high_y = high_x, nearest = high_x;
    for (std::size_t i = 0; i < 8; i += hn::Lanes(d)) {
        const VF s0 = hn::Load(d, kSigns[0] + i), s1 = hn::Load(d, kSigns[1] + i), s2 = hn::Load(d, kSigns[2] + i);
        VF clip[4];
        for (int k = 0; k < 4; ++k)
            clip[k] = hn::Add(hn::Add(hn::Set(d, middle[k]), hn::Mul(s0, hn::Set(d, edges[0][k]))),
                              hn::Add(hn::Mul(s1, hn::Set(d, edges[1][k])), hn::Mul(s2, hn::Set(d, edges[2][k]))));
        const VF inverse = hn::Div(hn::Set(d, 1.0f), clip[3]);
        const VF x = hn::Mul(clip[0], inverse), y = hn::Mul(clip[1], inverse), z = hn::Mul(clip[2], inverse);
        least_w = hn::Min(least_w, clip[3]);
        before_near = hn::Min(before_near, hn::Sub(hn::Mul(hn::Set(d, picture.near_share), clip[3]), clip[2]));
        low_x = hn::Min(low_x, x), high_x = hn::Max(high_x, x);
        low_y = hn::Min(low_y, y), high_y = hn::Max(high_y, y);
        nearest = hn::Max(nearest, z);
    }
    const auto least = [&](VF v) { return hn::GetLane(hn::MinOfLanes(d, v)); };
    const auto most = [&](VF v) { return hn::GetLane(hn::MaxOfLanes(d, v)); };
    Projection result{0, 0, 0, 0, infinity, least(least_w), Coverage::unclear};
    const float w = result.least_w - 8.0f * object.errors[3];
    if (!(w > 0.0f) || !(least(before_near) > 8.0f * (object.errors[2] + object.errors[3]))) return result;
    // Corners' own rounding is four times that of vertices.
    const float margin = 2.0f * picture.grid + 8.0f * pixel_error(picture, object, w);
    if (!(margin < 0.25f)) return result;
    const auto width = static_cast<float>(picture.tiles.width), height = static_cast<float>(picture.tiles.height);
    result.x0 = first_sample(least(low_x) * picture.half_width + picture.half_width - margin, width);
    result.x1 = last_sample(most(high_x) * picture.half_width + picture.half_width + margin, width);
    result.y0 = first_sample(least(low_y) * picture.half_height + picture.half_height - margin, height);
    result.y1 = last_sample(most(high_y) * picture.half_height + picture.half_height + margin, height);
    const float z = most(nearest);
    result.nearest = z + ((8.0f * (object.errors[2] + std::abs(z) * object.errors[3]) / w) + std::abs(z) * 0x1p-20f);
    result.coverage = result.x0 <= result.x1 && result.y0 <= result.y1 ? Coverage::samples : Coverage::nothing;
    if (!(result.nearest < infinity)) result.coverage = Coverage::unclear;
    return result;
}

}  // namespace crofton::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
