// SPDX-License-Identifier: MIT
// Where the boxes of clusters lie in the picture. Compiled once per instruction set (Highway).
#include <hwy/highway.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

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

// |product computed − product of reals| ≤ 4 · 2^-24 · Σ |terms| for a vertex, for the renderer as for us, in any order.
// No coordinate of the cluster is larger than its box's reach. The rounding of the sum itself is in the last factor.
HWY_INLINE ClipErrors clip_errors(const ObjectData& object, const Cluster& cluster) {
    float reach[3], errors[4];
    for (int k = 0; k < 3; ++k)
        reach[k] = (std::abs((&cluster.center.x)[k]) + std::abs((&cluster.half_edges[0].x)[k])) +
                   (std::abs((&cluster.half_edges[1].x)[k]) + std::abs((&cluster.half_edges[2].x)[k]));
    for (int i = 0; i < 4; ++i) {
        const float terms = (std::abs(object.columns[0][i]) * reach[0] + std::abs(object.columns[1][i]) * reach[1]) +
                            (std::abs(object.columns[2][i]) * reach[2] + std::abs(object.columns[3][i]));
        errors[i] = 0x1.00002p-21f * terms + object.moved[i];
    }
    return {errors[0], errors[1], errors[2], errors[3]};
}

// Pixels by which errors of clip coordinates may move a vertex, at a distance w from the eye, in or near the picture.
HWY_INLINE float pixel_error(const PictureData& picture, const ClipErrors& errors, float w) {
    const float x = (errors.x + 2.0f * errors.w) * picture.half_width;
    const float y = (errors.y + 2.0f * errors.w) * picture.half_height;
    return std::max(x, y) / w;
}

// A cluster whose vertices may move by more is drawn in clip coordinates, and listed always.
inline constexpr float kMaxPixelError = 0.25f;

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

// The corners of a cluster's box in clip coordinates, each off by at most 6 · 2^-24 · Σ |terms|. As vertices of the
// renderer are off by 4, they are within 1.25 times ClipErrors of the corners' hull.
class ClipBox {
  public:
    HWY_INLINE ClipBox(const ObjectData& object, const Cluster& cluster) {
        const float* const c = &cluster.center.x;
        for (int i = 0; i < 4; ++i) {
            middle_[i] = ((object.columns[0][i] * c[0] + object.columns[1][i] * c[1]) + object.columns[2][i] * c[2]) +
                         object.columns[3][i];
            for (int k = 0; k < 3; ++k) {
                const float* const h = &cluster.half_edges[static_cast<std::size_t>(k)].x;
                edges_[k][i] =
                    (object.columns[0][i] * h[0] + object.columns[1][i] * h[1]) + object.columns[2][i] * h[2];
            }
        }
    }

    static constexpr std::size_t kCorners = 8;
    HWY_INLINE void corners(std::size_t first, VF (&clip)[4]) const {
        alignas(32) static constexpr float kSigns[3][kCorners] = {
            {-1, 1, -1, 1, -1, 1, -1, 1}, {-1, -1, 1, 1, -1, -1, 1, 1}, {-1, -1, -1, -1, 1, 1, 1, 1}};
        const DF d;
        const VF s0 = hn::Load(d, kSigns[0] + first), s1 = hn::Load(d, kSigns[1] + first);
        const VF s2 = hn::Load(d, kSigns[2] + first);
        for (int k = 0; k < 4; ++k)
            clip[k] = hn::Add(hn::Add(hn::Set(d, middle_[k]), hn::Mul(s0, hn::Set(d, edges_[0][k]))),
                              hn::Add(hn::Mul(s1, hn::Set(d, edges_[1][k])), hn::Mul(s2, hn::Set(d, edges_[2][k]))));
    }

    // True if the box is beyond a side of the picture or before the near plane. The renderer's grid needs no margin:
    // the outermost samples are half a pixel from the side. Unlike a rectangle in the picture this is known of boxes
    // behind the eye, too.
    [[nodiscard]] bool is_outside(float near_share, const ClipErrors& errors) const {
        const DF d;
        const VF infinity = hn::Set(d, std::numeric_limits<float>::infinity());
        VF right = infinity, left = infinity, above = infinity, below = infinity, behind = hn::Neg(infinity);
        for (std::size_t i = 0; i < kCorners; i += hn::Lanes(d)) {
            VF clip[4];
            corners(i, clip);
            const VF edge = clip[3];
            right = hn::Min(right, hn::Sub(clip[0], edge)), left = hn::Min(left, hn::Sub(hn::Neg(clip[0]), edge));
            above = hn::Min(above, hn::Sub(clip[1], edge)), below = hn::Min(below, hn::Sub(hn::Neg(clip[1]), edge));
            behind = hn::Max(behind, hn::Sub(hn::Mul(hn::Set(d, near_share), clip[3]), clip[2]));
        }
        const auto least = [&](VF v) { return hn::GetLane(hn::MinOfLanes(d, v)); };
        const float limit = 2.0f * (std::max(errors.x, errors.y) + errors.w);
        return least(right) > limit || least(left) > limit || least(above) > limit || least(below) > limit ||
               hn::GetLane(hn::MaxOfLanes(d, behind)) < -2.0f * (errors.z + errors.w);
    }

  private:
    float middle_[4], edges_[3][4];
};

HWY_INLINE Projection project(const PictureData& picture, const ObjectData& object, const Cluster& cluster) {
    const DF d;
    const ClipBox box(object, cluster);
    const float infinity = std::numeric_limits<float>::infinity();
    VF least_w = hn::Set(d, infinity), before_near = hn::Set(d, infinity);
    VF low_x = least_w, high_x = hn::Neg(least_w), low_y = least_w, high_y = high_x, nearest = high_x;
    for (std::size_t i = 0; i < ClipBox::kCorners; i += hn::Lanes(d)) {
        VF clip[4];
        box.corners(i, clip);
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
    const ClipErrors errors = clip_errors(object, cluster);
    Projection result{0, 0, 0, 0, infinity, least(least_w), Coverage::unclear, errors};
    const float w = result.least_w - 2.0f * errors.w;
    const bool in_front = w > 0.0f && least(before_near) > 2.0f * (errors.z + errors.w);
    const float moved = in_front ? pixel_error(picture, errors, w) : infinity;
    if (!(moved < kMaxPixelError)) {
        if (box.is_outside(picture.near_share, errors)) result.coverage = Coverage::nothing;
        return result;
    }
    const float margin = 2.0f * (picture.grid + moved);
    const auto width = static_cast<float>(picture.tiles.width), height = static_cast<float>(picture.tiles.height);
    result.x0 = first_sample(least(low_x) * picture.half_width + picture.half_width - margin, width);
    result.x1 = last_sample(most(high_x) * picture.half_width + picture.half_width + margin, width);
    result.y0 = first_sample(least(low_y) * picture.half_height + picture.half_height - margin, height);
    result.y1 = last_sample(most(high_y) * picture.half_height + picture.half_height + margin, height);
    const float z = most(nearest);
    result.nearest = z + ((2.0f * (errors.z + std::abs(z) * errors.w) / w) + std::abs(z) * 0x1p-20f);
    result.coverage = result.x0 <= result.x1 && result.y0 <= result.y1 ? Coverage::samples : Coverage::nothing;
    if (!(result.nearest < infinity)) result.coverage = Coverage::unclear;
    return result;
}

}  // namespace crofton::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
