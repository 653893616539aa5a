// SPDX-License-Identifier: MIT
#include "choosing/choose_kernel.hpp"

// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace crofton::occlude::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;

HWY_INLINE V dot_with(const V* v, const float* constant) {
    const D d;
    return hn::Add(hn::Add(hn::Mul(v[0], hn::Set(d, constant[0])), hn::Mul(v[1], hn::Set(d, constant[1]))),
                   hn::Mul(v[2], hn::Set(d, constant[2])));
}

HWY_INLINE V dot_of(const V* a, const V* b) {
    return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2]));
}

// Returns the length of the ray from the point along `along` (of length `length`) that lies within the bounds.
HWY_INLINE V way_behind(const V* point, const V* along, V length, const ChooseView& view) {
    const D d;
    V end = hn::Set(d, 1e30f), begin = hn::Zero(d);
    for (std::size_t k = 0; k < 3; ++k) {
        const auto upward = hn::Ge(along[k], hn::Zero(d));
        const V size = hn::Max(hn::Abs(along[k]), hn::Set(d, 1e-20f));
        const V high = hn::Sub(hn::Set(d, view.high[k]), point[k]), low = hn::Sub(point[k], hn::Set(d, view.low[k]));
        end = hn::Min(end, hn::Div(hn::IfThenElse(upward, high, low), size));
        begin = hn::Max(begin, hn::Div(hn::Neg(hn::IfThenElse(upward, low, high)), size));
    }
    return hn::Mul(hn::Max(hn::Sub(end, begin), hn::Zero(d)), length);
}

struct Worth {
    V value;  // negative: what is covered, where one ray does not tell what that is worth
    hn::Mask<D> keep;
};

// Sums of products are rounded step by step, never fused: so all instruction sets agree.
HWY_INLINE Worth worth_of(const float* const* columns, std::size_t i, const ChooseView& view) {
    const D d;
    V point[3], center[3], area[3];
    for (std::size_t k = 0; k < 3; ++k) {
        point[k] = hn::LoadU(d, columns[k] + i);
        center[k] = hn::Sub(point[k], hn::Set(d, view.eye[k]));
    }
    const V radius = hn::LoadU(d, columns[3] + i), zero = hn::Zero(d);
    auto in_view = hn::Ge(radius, zero);
    for (std::size_t p = 0; p < view.plane_count; ++p) {
        const V above = hn::Add(dot_with(center, view.planes[p].data()), hn::Set(d, view.planes[p][3]));
        in_view = hn::And(in_view, hn::Ge(hn::Add(above, radius), zero));
    }
    V along[3];  // the direction times its length
    for (std::size_t k = 0; k < 3; ++k) along[k] = view.perspective ? center[k] : hn::Set(d, view.forward[k]);
    V faced = zero;
    for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t k = 0; k < 3; ++k) area[k] = hn::LoadU(d, columns[4 + 3 * a + k] + i);
        const V signed_area = dot_of(along, area);
        if (a == 0) {
            const auto hides = hn::Or(hn::Le(signed_area, zero), hn::Eq(hn::LoadU(d, columns[13] + i), zero));
            in_view = hn::And(in_view, hides);
        }
        faced = hn::Add(faced, hn::Abs(signed_area));
    }
    V cover = hn::Mul(faced, hn::Set(d, view.scale)), length = hn::Set(d, 1.0f);
    const V radius_square = hn::Mul(radius, radius);
    auto large = hn::Gt(radius_square, hn::Set(d, view.large_square));
    if (view.perspective) {
        // For distances below half the radius the quotient is meaningless.
        const V near = hn::Mul(radius_square, hn::Set(d, 0.25f));
        large = hn::Gt(radius_square, hn::Mul(dot_of(center, center), hn::Set(d, 0.0625f)));
        const V square = hn::Max(hn::Max(dot_of(center, center), near), hn::Set(d, 1e-30f));
        length = hn::Sqrt(square);
        cover = hn::Div(hn::Div(cover, square), length);
    }
    cover = hn::IfThenElseZero(in_view, cover);
    if (!view.bounded) return {cover, hn::Ge(cover, hn::Set(d, view.least))};
    const V value = hn::Mul(cover, way_behind(point, along, length, view));
    large = hn::And(large, in_view);
    const auto one_ray = hn::AndNot(large, hn::Gt(value, zero));
    const V many_rays = hn::Neg(hn::Max(cover, hn::Set(d, 1e-30f)));
    return {hn::IfThenElse(one_ray, value, many_rays), hn::Or(large, hn::Ge(cover, hn::Set(d, view.least)))};
}

std::size_t run_cover(const float* const* columns, std::size_t count, const ChooseView& view, std::uint32_t* seen,
                      float* values) {
    const D d;
    std::size_t found = 0;
    HWY_ALIGN float value[hn::MaxLanes(d)];
    for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
        const Worth worth = worth_of(columns, i, view);
        if (hn::AllFalse(d, worth.keep)) continue;
        hn::Store(hn::IfThenElseZero(worth.keep, worth.value), d, value);
        for (std::size_t k = 0; k < hn::Lanes(d) && i + k < count; ++k) {
            seen[found] = static_cast<std::uint32_t>(i + k);
            values[found] = value[k];
            found += value[k] != 0.0f ? 1 : 0;
        }
    }
    return found;
}

}  // namespace
}  // namespace crofton::occlude::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::occlude {

HWY_EXPORT(run_cover);

std::size_t measure_cover(const float* const* columns, std::size_t count, const ChooseView& view, std::uint32_t* seen,
                          float* values) {
    return HWY_DYNAMIC_DISPATCH(run_cover)(columns, count, view, seen, values);
}

}  // namespace crofton::occlude
#endif
