// SPDX-License-Identifier: MIT
// Lights against froxels, a pair of them a lane. Compiled once per instruction set (Highway).
//
// Error bounds. L ≥ the largest coordinate of any point of the light, s = spread ≥ 1 + |slope| of columns and of rows,
// E = start. In the part of the slab that the light reaches, boundaries lie within s L + E. With u the type's rounding,
// 2^-24 or 2^-53, a difference of a coordinate and a boundary is off by at most 6 u (s L + E). That covers the rounding
// of both, of slope and start, of product and sums. Moving a point of the exact froxel into the one of the rounded
// numbers, or back, first along w and then across, takes at most as much along each axis. That includes the shift of a
// boundary by a shift in w. In doubles the frame adds its own errors: axes and planes are unit vectors of at most ten
// roundings, 2^-49 (s L + E). So δ = kLightRounding (s L + E), with kLightRounding = 2^-21 for floats and 2^-45 for
// doubles, bounds each of them.
#include <hwy/highway.h>
#include <cstdint>

#include "lights/filter_light.hpp"

#if defined(CROFTON_CULL_LIGHT_TESTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_CULL_LIGHT_TESTS_INL
#undef CROFTON_CULL_LIGHT_TESTS_INL
#else
#define CROFTON_CULL_LIGHT_TESTS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class D>
struct Lit {
    hn::Mask<D> yes, no;  // for certain
};

// A light in each lane.
template <class D>
struct LightLanes {
    using Light = FilterLight<hn::TFromD<D>>;
    hn::Vec<D> at[3], axis[3], radius, cosine, sine, eta, inner, outer, keep;

    // `load` makes a vector of a member, which it is given a function for.
    template <class Load>
    HWY_INLINE explicit LightLanes(const Load& load) {
        for (int j = 0; j < 3; ++j) {
            at[j] = load([j](const Light& light) { return &light.at[j]; });
            axis[j] = load([j](const Light& light) { return &light.axis[j]; });
        }
        radius = load([](const Light& light) { return &light.radius; });
        cosine = load([](const Light& light) { return &light.cosine; });
        sine = load([](const Light& light) { return &light.sine; });
        eta = load([](const Light& light) { return &light.eta; });
        inner = load([](const Light& light) { return &light.inner; });
        outer = load([](const Light& light) { return &light.outer; });
        keep = load([](const Light& light) { return &light.keep; });
    }
    // One light in all lanes.
    static HWY_INLINE LightLanes all(const Light& light) {
        return LightLanes([&](const auto& member) HWY_ATTR { return hn::Set(D(), *member(light)); });
    }
    // Lights by their indices.
    static HWY_INLINE LightLanes gather(const Light* lights, hn::Vec<hn::RebindToSigned<D>> index) {
        const hn::RebindToSigned<D> d_index;
        static_assert(sizeof(Light) % sizeof(hn::TFromD<D>) == 0);
        const auto offset =
            hn::Mul(index, hn::Set(d_index, static_cast<std::int32_t>(sizeof(Light) / sizeof(hn::TFromD<D>))));
        return LightLanes([&](const auto& member) HWY_ATTR { return hn::GatherIndex(D(), member(*lights), offset); });
    }
};

// A froxel in each lane, and the part [low, high] of its slab that the light reaches.
template <class D>
struct FroxelLanes {
    using T = hn::TFromD<D>;
    using V = hn::Vec<D>;
    V slope[2][2], start[2][2];  // by axis: columns, rows; by side
    V low, high;

    // Neighbours of a row, from column `first` on.
    HWY_INLINE FroxelLanes(const FroxelArrays<T>& grid, std::size_t first, std::size_t row, T from, T to)
        : low(hn::Set(D(), from)), high(hn::Set(D(), to)) {
        const D d;
        for (std::size_t side = 0; side < 2; ++side) {
            slope[0][side] = hn::LoadU(d, grid.slope[0] + first + side);
            start[0][side] = hn::LoadU(d, grid.start[0] + first + side);
            slope[1][side] = hn::Set(d, grid.slope[1][row + side]);
            start[1][side] = hn::Set(d, grid.start[1][row + side]);
        }
    }
    // By their columns and rows.
    template <class I>
    HWY_INLINE FroxelLanes(const FroxelArrays<T>& grid, I column, I row, V from, V to) : low(from), high(to) {
        const D d;
        for (std::size_t side = 0; side < 2; ++side) {
            slope[0][side] = hn::GatherIndex(d, grid.slope[0] + side, column);
            start[0][side] = hn::GatherIndex(d, grid.start[0] + side, column);
            slope[1][side] = hn::GatherIndex(d, grid.slope[1] + side, row);
            start[1][side] = hn::GatherIndex(d, grid.start[1] + side, row);
        }
    }
    HWY_INLINE V column(std::size_t side, V w) const { return hn::MulAdd(slope[0][side], w, start[0][side]); }
    HWY_INLINE V row(std::size_t side, V w) const { return hn::MulAdd(slope[1][side], w, start[1][side]); }
};

// The nearest point of the froxels at depth w, how far it is, and half the slope of the distance's square along w.
template <class D>
struct NearestAt {
    using V = hn::Vec<D>;
    V u, v, w, square, slope, curvature;

    HWY_INLINE NearestAt(const FroxelLanes<D>& froxels, V u0, V v0, V w0, V depth) : w(depth) {
        const D d;
        u = hn::Max(froxels.column(0, w), hn::Min(froxels.column(1, w), u0));
        v = hn::Max(froxels.row(0, w), hn::Min(froxels.row(1, w), v0));
        const V du = hn::Sub(u, u0), dv = hn::Sub(v, v0), dw = hn::Sub(w, w0);
        const V across = pick(du, froxels.slope[0][0], froxels.slope[0][1]),
                upward = pick(dv, froxels.slope[1][0], froxels.slope[1][1]);
        square = hn::MulAdd(du, du, hn::MulAdd(dv, dv, hn::Mul(dw, dw)));
        slope = hn::MulAdd(du, across, hn::MulAdd(dv, upward, dw));
        curvature = hn::MulAdd(across, across, hn::MulAdd(upward, upward, hn::Set(d, hn::TFromD<D>(1))));
    }
    // By the boundary that the nearest point lies on; 0 for none.
    static HWY_INLINE V pick(V by, V lower, V upper) {
        const V zero = hn::Zero(D());
        const V other = hn::IfThenElseZero(hn::Lt(by, zero), upper);
        return hn::IfThenElse(hn::Gt(by, zero), lower, other);
    }
    // Where Newton's step leads: the slope is linear between the kinks.
    HWY_INLINE V next(V low, V high) const {
        return hn::Max(low, hn::Min(high, hn::Sub(w, hn::Div(slope, curvature))));
    }
};

// The square of the distance to the froxel's section at depth w, F(w), is convex, F − w² too. So for any w no point of
// the slab is nearer than F(w) − (F'(w)/2)², or than F(w) where the slope leads out of the slab. A point at F(w) there
// is. F and F'²/4 ≤ s² F are off by 2 s² √F (δ + kLightTrifle √F) in all. Where F ≥ R² that is below κ F, which the
// first term of the bound gives up. Where F < R² nothing is claimed. The slope's sign may be wrong where it is below s
// δ, which η² covers.
template <class D>
HWY_INLINE Lit<D> test_sphere(const FroxelLanes<D>& froxels, const LightLanes<D>& light) {
    const D d;
    using V = hn::Vec<D>;
    const V u0 = light.at[0], v0 = light.at[1], w0 = light.at[2], low = froxels.low, high = froxels.high;
    Lit<D> lit{hn::FirstN(d, 0), hn::FirstN(d, 0)};
    V w = hn::Max(low, hn::Min(high, w0));
    for (int round = 0;; ++round) {
        const NearestAt<D> at(froxels, u0, v0, w0, w);
        const auto ends = hn::Or(hn::And(hn::Ge(at.slope, hn::Zero(d)), hn::Le(w, low)),
                                 hn::And(hn::Le(at.slope, hn::Zero(d)), hn::Ge(w, high)));
        const V slope = hn::IfThenZeroElse(ends, at.slope);
        const V bound = hn::NegMulAdd(slope, slope, hn::Mul(at.square, light.keep));
        lit.yes = hn::Or(lit.yes, hn::Lt(at.square, light.inner));
        lit.no = hn::Or(lit.no, hn::Gt(bound, light.outer));
        if (round == 3 || hn::AllTrue(d, hn::Or(lit.yes, lit.no))) return lit;
        w = at.next(low, high);
    }
}

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
