// SPDX-License-Identifier: MIT
// Tries sixteen frames about one axis at once.
#include "small_set/kernels.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "small_set/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::fit::kernels::HWY_NAMESPACE {

// cos and sin of sixteen angles that divide a right angle.
constexpr float kCosine[kLanes] = {1.0f,        0.99518472f, 0.98078527f, 0.95694035f, 0.92387952f, 0.88192129f,
                                   0.83146960f, 0.77301043f, 0.70710677f, 0.63439327f, 0.55557024f, 0.47139674f,
                                   0.38268343f, 0.29028466f, 0.19509032f, 0.09801714f};
constexpr float kSine[kLanes] = {0.0f,        0.09801714f, 0.19509032f, 0.29028466f, 0.38268343f, 0.47139674f,
                                 0.55557024f, 0.63439327f, 0.70710677f, 0.77301043f, 0.83146960f, 0.88192129f,
                                 0.92387952f, 0.95694035f, 0.98078527f, 0.99518472f};

// Values of sixteen rectangles' frames; of each of the four sides the index of its first support point, right, up,
// left, down in sequence, where `supports` is given.
template <bool kSupports>
HWY_INLINE void rectangles(const float* px, const float* py, std::size_t count, float depth,
                           const FloatWeights& weights, const float* cosines, const float* sines, float* values,
                           float* supports) {
    const Tag d;
    for (std::size_t lane = 0; lane < kLanes; lane += hn::Lanes(d)) {
        const auto c = hn::LoadU(d, cosines + lane), s = hn::LoadU(d, sines + lane);
        Range along = nothing(d), up = along;
        auto right_most = hn::Zero(d), left_most = right_most, top_most = right_most, bottom_most = right_most;
        for (std::size_t i = 0; i < count; ++i) {
            const auto x = hn::Set(d, px[i]), y = hn::Set(d, py[i]);
            const auto a = hn::Add(hn::Mul(c, x), hn::Mul(s, y)), b = hn::Sub(hn::Mul(c, y), hn::Mul(s, x));
            if constexpr (kSupports) {
                const auto index = hn::Set(d, static_cast<float>(i));
                right_most = hn::IfThenElse(hn::Gt(a, along.high), index, right_most);
                left_most = hn::IfThenElse(hn::Lt(a, along.low), index, left_most);
                top_most = hn::IfThenElse(hn::Gt(b, up.high), index, top_most);
                bottom_most = hn::IfThenElse(hn::Lt(b, up.low), index, bottom_most);
            }
            along.include(a);
            up.include(b);
        }
        hn::StoreU(value(d, weights, along.width(), up.width(), hn::Set(d, depth)), d, values + lane);
        if constexpr (kSupports) {
            hn::StoreU(right_most, d, supports + lane);
            hn::StoreU(top_most, d, supports + kLanes + lane);
            hn::StoreU(left_most, d, supports + 2 * kLanes + lane);
            hn::StoreU(bottom_most, d, supports + 3 * kLanes + lane);
        }
    }
}

HWY_INLINE std::size_t index_of_least(const float* values) {
    const Tag d;
    auto least = hn::LoadU(d, values);
    for (std::size_t lane = hn::Lanes(d); lane < kLanes; lane += hn::Lanes(d))
        least = hn::Min(least, hn::LoadU(d, values + lane));
    least = hn::MinOfLanes(d, least);
    for (std::size_t lane = 0; lane < kLanes; lane += hn::Lanes(d)) {
        const auto at = hn::FindFirstTrue(d, hn::Eq(hn::LoadU(d, values + lane), least));
        if (at >= 0) return lane + static_cast<std::size_t>(at);
    }
    return 0;
}

void turn_frame(const SmallSet& points, const FloatWeights& weights, float* scratch, Turn& turn) {
    const Tag d;
    const std::size_t padded = (points.count + kLanes - 1) / kLanes * kLanes;
    float* const px = scratch;
    float* const py = scratch + padded;
    const Vec3 axis = set(d, turn.axis), right = set(d, turn.right), up = set(d, turn.up);
    Range depths = nothing(d);
    for (std::size_t i = 0; i < padded; i += hn::Lanes(d)) {
        const Vec3 p = load(d, points, i);
        depths.include(dot(axis, p));
        hn::StoreU(dot(right, p), d, px + i);
        hn::StoreU(dot(up, p), d, py + i);
    }
    const float depth = hn::GetLane(hn::MaxOfLanes(d, depths.high)) - hn::GetLane(hn::MinOfLanes(d, depths.low));
    float values[kLanes], supports[4 * kLanes];
    rectangles<true>(px, py, points.count, depth, weights, kCosine, kSine, values, supports);
    const std::size_t coarse = index_of_least(values);
    // The chords between the support points two steps before the best angle to two steps after it, of each side.
    float cosines[kLanes], sines[kLanes];
    for (std::size_t side = 0; side < 4; ++side)
        for (std::size_t step = 0; step < 4; ++step) {
            const std::size_t from = (side * kLanes + coarse + 4 * kLanes - 2 + step) % (4 * kLanes);
            const int p = static_cast<int>(supports[from]);
            const int q = static_cast<int>(supports[(from + 1) % (4 * kLanes)]);
            cosines[4 * side + step] = px[q] - px[p];
            sines[4 * side + step] = py[q] - py[p];
        }
    const auto tiny = hn::Set(d, 1e-12f);
    const auto coarse_cosine = hn::Set(d, kCosine[coarse]), coarse_sine = hn::Set(d, kSine[coarse]);
    for (std::size_t lane = 0; lane < kLanes; lane += hn::Lanes(d)) {
        const auto c = hn::LoadU(d, cosines + lane), s = hn::LoadU(d, sines + lane);
        const auto squared = hn::Add(hn::Mul(c, c), hn::Mul(s, s)), length = hn::Sqrt(squared);
        const auto chord = hn::Gt(squared, tiny);
        hn::StoreU(hn::IfThenElse(chord, hn::Div(c, length), coarse_cosine), d, cosines + lane);
        hn::StoreU(hn::IfThenElse(chord, hn::Div(s, length), coarse_sine), d, sines + lane);
    }
    rectangles<false>(px, py, points.count, depth, weights, cosines, sines, values, nullptr);
    const std::size_t best = index_of_least(values);
    turn.cosine = cosines[best];
    turn.sine = sines[best];
    turn.value = values[best];
}

}  // namespace crofton::fit::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::fit::kernels {

HWY_EXPORT(turn_frame);

void turn_frame(const SmallSet& points, const FloatWeights& weights, float* scratch, Turn& turn) {
    HWY_DYNAMIC_DISPATCH(turn_frame)(points, weights, scratch, turn);
}

}  // namespace crofton::fit::kernels
#endif
