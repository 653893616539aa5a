// SPDX-License-Identifier: MIT
#include "small_set/kernels.hpp"

#include <bit>

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <crofton/simd/mask_bits-inl.hpp>

#include "small_set/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::fit::kernels::HWY_NAMESPACE {

namespace simd = crofton::simd::HWY_NAMESPACE;

void find_extremes(const SmallSet& points, const Directions& directions, float* least, float* greatest) {
    const Tag d;
    for (std::size_t lane = 0; lane < kLanes; lane += hn::Lanes(d)) {
        const Vec3 direction = {hn::LoadU(d, directions.x + lane), hn::LoadU(d, directions.y + lane),
                                hn::LoadU(d, directions.z + lane)};
        Range range = nothing(d);
        auto low = hn::Zero(d), high = hn::Zero(d);
        for (std::size_t i = 0; i < points.count; ++i) {
            const auto t = dot(direction, broadcast(d, points, i));
            const auto index = hn::Set(d, static_cast<float>(i));
            low = hn::IfThenElse(hn::Lt(t, range.low), index, low);
            high = hn::IfThenElse(hn::Gt(t, range.high), index, high);
            range.include(t);
        }
        hn::StoreU(low, d, least + lane);
        hn::StoreU(high, d, greatest + lane);
    }
}

void find_ranks(const SmallSet& points, float* ranks) {
    const Tag d;
    const auto one = hn::Set(d, 1.0f);
    for (std::size_t i = 0; i < points.count; i += hn::Lanes(d)) {
        const auto x = hn::LoadU(d, points.x + i), y = hn::LoadU(d, points.y + i), z = hn::LoadU(d, points.z + i);
        auto before = hn::Zero(d);
        for (std::size_t j = 0; j < points.count; ++j) {
            const Vec3 p = broadcast(d, points, j);
            const auto by_z = hn::And(hn::Eq(p.y, y), hn::Lt(p.z, z));
            const auto by_y = hn::And(hn::Eq(p.x, x), hn::Or(hn::Lt(p.y, y), by_z));
            before = hn::Add(before, hn::IfThenElseZero(hn::Or(hn::Lt(p.x, x), by_y), one));
        }
        hn::StoreU(before, d, ranks + i);
    }
}

void best_frames(const SmallSet& points, const FloatWeights& weights, const float* frames, std::size_t count,
                 float* values, float* rows) {
    const Tag d;
    for (std::size_t lane = 0; lane < kLanes; lane += hn::Lanes(d)) {
        auto best = hn::Set(d, kHuge), row = hn::Zero(d);
        for (std::size_t i = lane; i < count; i += kLanes) {
            const auto axis = [&](std::size_t k) {
                const float* at = frames + 3 * k * count + i;
                return Vec3{hn::LoadU(d, at), hn::LoadU(d, at + count), hn::LoadU(d, at + 2 * count)};
            };
            const auto found = value_in_frame(d, points, weights, axis(0), axis(1), axis(2));
            row = hn::IfThenElse(hn::Lt(found, best), hn::Set(d, static_cast<float>(i / kLanes)), row);
            best = hn::Min(best, found);
        }
        hn::StoreU(best, d, values + lane);
        hn::StoreU(row, d, rows + lane);
    }
}

void supports_of_frame(const SmallSet& points, const float frame[9], float supports[6], float widths[3]) {
    const Tag d;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 axis = set(d, frame + 3 * k);
        Range range = nothing(d);
        auto low = hn::Zero(d), high = hn::Zero(d);
        for (std::size_t i = 0; i < points.count; i += hn::Lanes(d)) {
            const auto t = dot(axis, load(d, points, i));
            const auto index = hn::Iota(d, static_cast<float>(i));
            low = hn::IfThenElse(hn::Lt(t, range.low), index, low);
            high = hn::IfThenElse(hn::Gt(t, range.high), index, high);
            range.include(t);
        }
        // The least index among the lanes with the extreme value wins. Padding repeats point 0, which then wins itself.
        const auto none = hn::Set(d, kHuge);
        const auto least = hn::MinOfLanes(d, range.low), greatest = hn::MaxOfLanes(d, range.high);
        supports[2 * k] = hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(hn::Eq(range.high, greatest), high, none)));
        supports[2 * k + 1] = hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(hn::Eq(range.low, least), low, none)));
        widths[k] = hn::GetLane(greatest) - hn::GetLane(least);
    }
}

struct Angle {
    float cosine, sine;
};
// 12, 8, 5 and 2.5 degrees; then 3, 2, 1.2 and 0.6.
constexpr Angle kTurns[2][4] = {
    {{0.97814760f, 0.20791169f}, {0.99026807f, 0.13917310f}, {0.99619470f, 0.08715574f}, {0.99904822f, 0.04361939f}},
    {{0.99862953f, 0.05233596f}, {0.99939083f, 0.03489950f}, {0.99978068f, 0.02094242f}, {0.99994517f, 0.01047178f}}};

// One step of descend_frames: turns the frame of each lane about axes[k] to the best of nine angles; returns the
// values.
HWY_INLINE Lane turn_about(const SmallSet& points, const FloatWeights& weights, const Angle angles[4], std::size_t k,
                           Vec3 axes[3], float* scratch) {
    const Tag d;
    const Vec3 axis = axes[k];
    Vec3 &right = axes[(k + 1) % 3], &up = axes[(k + 2) % 3];
    Range depths = nothing(d), along_right = depths, along_up = depths;
    for (std::size_t i = 0; i < points.count; ++i) {
        const Vec3 p = broadcast(d, points, i);
        depths.include(dot(axis, p));
        const auto x = dot(right, p), y = dot(up, p);
        along_right.include(x);
        along_up.include(y);
        hn::StoreU(x, d, scratch + 2 * kLanes * i);
        hn::StoreU(y, d, scratch + 2 * kLanes * i + kLanes);
    }
    const auto depth = depths.width();
    auto best = value(d, weights, along_right.width(), along_up.width(), depth);
    auto cosine = hn::Set(d, 1.0f), sine = hn::Zero(d);
    const auto keep_better = [&](Lane found, Lane c, Lane s) {
        const auto better = hn::Lt(found, best);
        best = hn::Min(best, found);
        cosine = hn::IfThenElse(better, c, cosine);
        sine = hn::IfThenElse(better, s, sine);
    };
    for (std::size_t j = 0; j < 4; ++j) {
        const auto c = hn::Set(d, angles[j].cosine), s = hn::Set(d, angles[j].sine);
        Range a = nothing(d), b = a, a_back = a, b_back = a;
        for (std::size_t i = 0; i < points.count; ++i) {
            const auto x = hn::LoadU(d, scratch + 2 * kLanes * i);
            const auto y = hn::LoadU(d, scratch + 2 * kLanes * i + kLanes);
            const auto cx = hn::Mul(c, x), sx = hn::Mul(s, x), cy = hn::Mul(c, y), sy = hn::Mul(s, y);
            a.include(hn::Add(cx, sy));
            b.include(hn::Sub(cy, sx));
            a_back.include(hn::Sub(cx, sy));
            b_back.include(hn::Add(cy, sx));
        }
        keep_better(value(d, weights, a.width(), b.width(), depth), c, s);
        keep_better(value(d, weights, a_back.width(), b_back.width(), depth), c, hn::Neg(s));
    }
    const Vec3 c_right = scaled(right, cosine), s_up = scaled(up, sine);
    const Vec3 c_up = scaled(up, cosine), s_right = scaled(right, sine);
    right = {hn::Add(c_right.x, s_up.x), hn::Add(c_right.y, s_up.y), hn::Add(c_right.z, s_up.z)};
    up = {hn::Sub(c_up.x, s_right.x), hn::Sub(c_up.y, s_right.y), hn::Sub(c_up.z, s_right.z)};
    return best;
}

void descend_frames(const SmallSet& points, const FloatWeights& weights, float* scratch, FrameLanes& frames) {
    const Tag d;
    for (std::size_t lane = 0; lane < kLanes; lane += hn::Lanes(d)) {
        Vec3 axes[3];
        for (std::size_t k = 0; k < 3; ++k)
            axes[k] = {hn::LoadU(d, frames.axes[3 * k] + lane), hn::LoadU(d, frames.axes[3 * k + 1] + lane),
                       hn::LoadU(d, frames.axes[3 * k + 2] + lane)};
        auto best = hn::Set(d, kHuge);
        for (std::size_t step = 0; step < 6; ++step)
            best = turn_about(points, weights, kTurns[step / 3], step % 3, axes, scratch);
        hn::StoreU(best, d, frames.values + lane);
        for (std::size_t k = 0; k < 3; ++k) {
            hn::StoreU(axes[k].x, d, frames.axes[3 * k] + lane);
            hn::StoreU(axes[k].y, d, frames.axes[3 * k + 1] + lane);
            hn::StoreU(axes[k].z, d, frames.axes[3 * k + 2] + lane);
        }
    }
}

void supports_of_frames(const SmallSet& points, const FloatWeights& weights, FrameLanes& frames, float* supports) {
    const Tag d;
    for (std::size_t lane = 0; lane < kLanes; lane += hn::Lanes(d)) {
        Range range[3];
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 axis = {hn::LoadU(d, frames.axes[3 * k] + lane), hn::LoadU(d, frames.axes[3 * k + 1] + lane),
                               hn::LoadU(d, frames.axes[3 * k + 2] + lane)};
            range[k] = nothing(d);
            auto low = hn::Zero(d), high = hn::Zero(d);
            for (std::size_t i = 0; i < points.count; ++i) {
                const auto t = dot(axis, broadcast(d, points, i));
                const auto index = hn::Set(d, static_cast<float>(i));
                low = hn::IfThenElse(hn::Lt(t, range[k].low), index, low);
                high = hn::IfThenElse(hn::Gt(t, range[k].high), index, high);
                range[k].include(t);
            }
            hn::StoreU(high, d, supports + 2 * k * kLanes + lane);
            hn::StoreU(low, d, supports + (2 * k + 1) * kLanes + lane);
        }
        hn::StoreU(value(d, weights, range[0].width(), range[1].width(), range[2].width()), d, frames.values + lane);
    }
}

void values_of_slides(const SmallSet& points, const FloatWeights& weights, Slides& slides) {
    const Tag d;
    const Vec3 start = set(d, slides.start), across = set(d, slides.across), edge = set(d, slides.edge);
    const auto one = hn::Set(d, 1.0f);
    for (std::size_t lane = 0; lane < kLanes; lane += hn::Lanes(d)) {
        const auto t = hn::LoadU(d, slides.t + lane);
        const auto shrink = hn::Div(one, hn::Sqrt(hn::Add(one, hn::Mul(t, t))));
        const Vec3 moved = scaled(across, t);
        const Vec3 n =
            scaled({hn::Add(start.x, moved.x), hn::Add(start.y, moved.y), hn::Add(start.z, moved.z)}, shrink);
        const Vec3 m = cross(edge, n);
        const auto squared = dot(m, m);
        const auto usable = hn::Gt(squared, hn::Set(d, 1e-4f));
        const Vec3 unit = scaled(m, hn::Div(one, hn::Sqrt(hn::IfThenElse(usable, squared, one))));
        const auto result = value_in_frame(d, points, weights, n, unit, cross(n, unit));
        hn::StoreU(hn::IfThenElse(usable, result, hn::Set(d, kHuge)), d, slides.values + lane);
    }
}

// Appends the lanes of `mask`, as indices from `base`, below `count`, while there is room.
HWY_INLINE void append(Tag d, hn::Mask<Tag> mask, std::size_t base, std::size_t count, FlushSide& side) {
    if (hn::AllFalse(d, mask)) return;
    for (std::uint32_t bits = simd::mask_bits(d, mask); bits != 0; bits &= bits - 1) {
        const std::size_t index = base + static_cast<std::size_t>(std::countr_zero(bits));
        if (index < count && side.count < kMostFlush) side.indices[side.count++] = static_cast<std::uint32_t>(index);
    }
}

void flush_points(const SmallSet& points, const float frame[9], float tolerance, float* scratch, FlushSide sides[6]) {
    const Tag d;
    const auto near = hn::Set(d, tolerance);
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 axis = set(d, frame + 3 * k);
        Range range = nothing(d);
        for (std::size_t i = 0; i < points.count; i += hn::Lanes(d)) {
            const auto t = dot(axis, load(d, points, i));
            range.include(t);
            hn::StoreU(t, d, scratch + i);
        }
        const auto high = hn::MaxOfLanes(d, range.high), low = hn::MinOfLanes(d, range.low);
        sides[2 * k].count = sides[2 * k + 1].count = 0;
        for (std::size_t i = 0; i < points.count; i += hn::Lanes(d)) {
            const auto t = hn::LoadU(d, scratch + i);
            append(d, hn::Le(hn::Sub(high, t), near), i, points.count, sides[2 * k]);
            append(d, hn::Le(hn::Sub(t, low), near), i, points.count, sides[2 * k + 1]);
        }
    }
}

}  // namespace crofton::fit::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::fit::kernels {

HWY_EXPORT(find_extremes);
HWY_EXPORT(best_frames);
HWY_EXPORT(find_ranks);
HWY_EXPORT(supports_of_frame);
HWY_EXPORT(descend_frames);
HWY_EXPORT(supports_of_frames);
HWY_EXPORT(values_of_slides);
HWY_EXPORT(flush_points);

void find_extremes(const SmallSet& points, const Directions& directions, float* least, float* greatest) {
    HWY_DYNAMIC_DISPATCH(find_extremes)(points, directions, least, greatest);
}
void best_frames(const SmallSet& points, const FloatWeights& weights, const float* frames, std::size_t count,
                 float* values, float* rows) {
    HWY_DYNAMIC_DISPATCH(best_frames)(points, weights, frames, count, values, rows);
}
void descend_frames(const SmallSet& points, const FloatWeights& weights, float* scratch, FrameLanes& frames) {
    HWY_DYNAMIC_DISPATCH(descend_frames)(points, weights, scratch, frames);
}
void supports_of_frames(const SmallSet& points, const FloatWeights& weights, FrameLanes& frames, float* supports) {
    HWY_DYNAMIC_DISPATCH(supports_of_frames)(points, weights, frames, supports);
}
void supports_of_frame(const SmallSet& points, const float frame[9], float supports[6], float widths[3]) {
    HWY_DYNAMIC_DISPATCH(supports_of_frame)(points, frame, supports, widths);
}
void find_ranks(const SmallSet& points, float* ranks) {
    HWY_DYNAMIC_DISPATCH(find_ranks)(points, ranks);
}
void values_of_slides(const SmallSet& points, const FloatWeights& weights, Slides& slides) {
    HWY_DYNAMIC_DISPATCH(values_of_slides)(points, weights, slides);
}
void flush_points(const SmallSet& points, const float frame[9], float tolerance, float* scratch, FlushSide sides[6]) {
    HWY_DYNAMIC_DISPATCH(flush_points)(points, frame, tolerance, scratch, sides);
}

}  // namespace crofton::fit::kernels
#endif
