// SPDX-License-Identifier: MIT
// Lights against neighbouring froxels of one row, a froxel a lane. Compiled once per instruction set (Highway).
//
// Error bounds. L ≥ the largest coordinate of any point of the light, s = spread ≥ 1 + |slope| of columns and of rows,
// E = start. In the part of the slab that the light reaches, boundaries lie within s L + E. With u the type's rounding,
// 2^-24 or 2^-53, a difference of a coordinate and a boundary is off by at most 6 u (s L + E): by the rounding of both,
// of slope and start, of product and sums. Moving a point of the exact froxel into the one of the rounded numbers, or
// back, first along w and then across, takes at most as much along each axis, the shift of a boundary by a shift in w
// included. In doubles the frame adds its own errors: axes and planes are unit vectors of at most ten roundings, 2^-49
// (s L + E). So δ = kTiny (s L + E), with kTiny = 2^-21 for floats and 2^-45 for doubles, bounds each of them.
#include <hwy/highway.h>
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "lights/froxel_kernel.hpp"

#if defined(CROFTON_CULL_LIGHT_TESTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_CULL_LIGHT_TESTS_INL
#undef CROFTON_CULL_LIGHT_TESTS_INL
#else
#define CROFTON_CULL_LIGHT_TESTS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class T>
inline constexpr T kTiny = std::is_same_v<T, float> ? T(0x1p-21) : T(0x1p-45);
template <class T>
inline constexpr T kTrifle = std::is_same_v<T, float> ? T(0x1p-18) : T(0x1p-40);  // of relative errors

// A light as a filter reads it.
template <class T>
struct FilterLight {
    T at[3], axis[3], radius, cosine, sine;
    T eta;    // 8 s δ
    T inner;  // (radius − η)², less a trifle; −1 where that says nothing
    T outer;  // (R + η)² for an R ≥ radius
    T keep;   // 1 − κ, κ = s² (kTrifle + 4 δ / R)
    bool is_spot;

    FilterLight(const FroxelKernelGrid& grid, const KernelLight& light) : is_spot(light.is_spot) {
        T largest = 0;
        for (int j = 0; j < 3; ++j) {
            at[j] = static_cast<T>(light.at[j]);
            axis[j] = static_cast<T>(light.axis[j]);
            largest = std::max(largest, std::fabs(at[j]));
        }
        radius = static_cast<T>(light.radius);
        cosine = static_cast<T>(light.cosine);
        sine = static_cast<T>(light.sine);
        const T s = static_cast<T>(grid.spread);
        const T delta = kTiny<T> * (s * (largest + radius) + static_cast<T>(grid.start));
        eta = 8 * s * delta;
        const T within = radius - eta, least = std::max(radius, 16 * s * s * delta);
        inner = within > 0 ? within * within * (1 - kTrifle<T>) : T(-1);
        outer = (least + eta) * (least + eta) * (1 + kTrifle<T>);
        keep = 1 - s * s * (kTrifle<T> + 4 * delta / least);
    }
};

template <class D>
struct Lit {
    hn::Mask<D> yes, no;  // for certain
};

// Froxels of a row from `first` on, and the part [low, high] of their slab that the light reaches.
template <class D>
struct FroxelLanes {
    using T = hn::TFromD<D>;
    using V = hn::Vec<D>;
    V slope[2], start[2];  // of the left and right boundaries
    T row_slope[2], row_start[2], low, high;

    HWY_INLINE FroxelLanes(const FroxelArrays<T>& grid, std::size_t first, std::size_t row, T from, T to)
        : low(from), high(to) {
        const D d;
        for (std::size_t side = 0; side < 2; ++side) {
            slope[side] = hn::LoadU(d, grid.slope[0] + first + side);
            start[side] = hn::LoadU(d, grid.start[0] + first + side);
            row_slope[side] = grid.slope[1][row + side];
            row_start[side] = grid.start[1][row + side];
        }
    }
    HWY_INLINE V column(std::size_t side, V w) const { return hn::MulAdd(slope[side], w, start[side]); }
    HWY_INLINE V row(std::size_t side, V w) const {
        const D d;
        return hn::MulAdd(hn::Set(d, row_slope[side]), w, hn::Set(d, row_start[side]));
    }
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
        const V across = pick(du, froxels.slope[0], froxels.slope[1]),
                upward = pick(dv, hn::Set(d, froxels.row_slope[0]), hn::Set(d, froxels.row_slope[1]));
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
// the slab is nearer than F(w) − (F'(w)/2)², or than F(w) where the slope leads out of the slab; and one at F(w) there
// is. F and F'²/4 ≤ s² F are off by 2 s² √F (δ + kTrifle √F) in all: where F ≥ R² that is below κ F, which the first
// term of the bound gives up; where F < R² nothing is claimed. The slope's sign may be wrong where it is below s δ,
// which η² covers.
template <class D>
HWY_INLINE Lit<D> test_ball(const FroxelLanes<D>& froxels, const FilterLight<hn::TFromD<D>>& light) {
    const D d;
    using V = hn::Vec<D>;
    const V u0 = hn::Set(d, light.at[0]), v0 = hn::Set(d, light.at[1]), w0 = hn::Set(d, light.at[2]);
    const V low = hn::Set(d, froxels.low), high = hn::Set(d, froxels.high);
    Lit<D> lit{hn::FirstN(d, 0), hn::FirstN(d, 0)};
    V w = hn::Max(low, hn::Min(high, w0));
    for (int round = 0;; ++round) {
        const NearestAt<D> at(froxels, u0, v0, w0, w);
        const auto ends = hn::Or(hn::And(hn::Ge(at.slope, hn::Zero(d)), hn::Le(w, low)),
                                 hn::And(hn::Le(at.slope, hn::Zero(d)), hn::Ge(w, high)));
        const V slope = hn::IfThenZeroElse(ends, at.slope);
        const V bound = hn::NegMulAdd(slope, slope, hn::Mul(at.square, hn::Set(d, light.keep)));
        lit.yes = hn::Or(lit.yes, hn::Lt(at.square, hn::Set(d, light.inner)));
        lit.no = hn::Or(lit.no, hn::Gt(bound, hn::Set(d, light.outer)));
        if (round == 3 || hn::AllTrue(d, hn::Or(lit.yes, lit.no))) return lit;
        w = at.next(low, high);
    }
}

// A point or a direction in each lane.
template <class D>
struct Vectors {
    hn::Vec<D> u, v, w;

    HWY_INLINE hn::Vec<D> dot(const Vectors& o) const {
        return hn::MulAdd(u, o.u, hn::MulAdd(v, o.v, hn::Mul(w, o.w)));
    }
    HWY_INLINE Vectors plus(const Vectors& o, hn::Vec<D> times) const {
        return {hn::MulAdd(o.u, times, u), hn::MulAdd(o.v, times, v), hn::MulAdd(o.w, times, w)};
    }
};

// A spot light's cone with its cap, in coordinates relative to its apex.
template <class D>
struct Sector {
    using V = hn::Vec<D>;
    Vectors<D> axis;
    V cosine, sine, range, eta;

    HWY_INLINE explicit Sector(const FilterLight<hn::TFromD<D>>& light) {
        const D d;
        axis = {hn::Set(d, light.axis[0]), hn::Set(d, light.axis[1]), hn::Set(d, light.axis[2])};
        cosine = hn::Set(d, light.cosine);
        sine = hn::Set(d, light.sine);
        range = hn::Set(d, light.radius);
        eta = hn::Set(d, light.eta);
    }

    // What is along the axis, and what is left of it.
    struct Split {
        V along, across;
        Vectors<D> rest;
    };
    HWY_INLINE Split split(const Vectors<D>& y) const {
        const V along = y.dot(axis);
        const Vectors<D> rest = y.plus(axis, hn::Neg(along));
        return {along, hn::Sqrt(rest.dot(rest)), rest};
    }

    // A ball of radius η around y lies within.
    HWY_INLINE hn::Mask<D> contains(const Vectors<D>& y, const Split& of) const {
        const V margin = hn::Sub(range, eta);
        const V to_side = hn::Sub(hn::Mul(of.along, sine), hn::Mul(of.across, cosine));
        const auto in_range = hn::And(hn::Gt(margin, hn::Zero(D())), hn::Lt(y.dot(y), hn::Mul(margin, margin)));
        return hn::And(in_range, hn::Gt(to_side, eta));
    }

    // The point nearest to y.
    HWY_INLINE Vectors<D> nearest(const Vectors<D>& y, const Split& of) const {
        const D d;
        const V zero = hn::Zero(d), least = hn::Set(d, hn::TFromD<D>(1e-30));
        const auto in_cone = hn::Le(hn::Mul(of.across, cosine), hn::Mul(of.along, sine));
        const V length = hn::Sqrt(hn::Max(y.dot(y), hn::Mul(least, least)));
        const V shrink = hn::Min(hn::Set(d, hn::TFromD<D>(1)), hn::Div(range, hn::Max(length, least)));
        const V on_side = hn::Max(zero, hn::Min(range, hn::MulAdd(of.along, cosine, hn::Mul(of.across, sine))));
        const V of_axis = hn::Mul(on_side, cosine),
                of_rest = hn::Div(hn::Mul(on_side, sine), hn::Max(of.across, least));
        const auto component = [&](V whole, V axial, V rest) HWY_ATTR {
            return hn::IfThenElse(in_cone, hn::Mul(whole, shrink), hn::MulAdd(axial, of_axis, hn::Mul(rest, of_rest)));
        };
        return {component(y.u, axis.u, of.rest.u), component(y.v, axis.v, of.rest.v),
                component(y.w, axis.w, of.rest.w)};
    }

    // The largest m · y within.
    HWY_INLINE V reach(const Vectors<D>& m) const {
        const Split of = split(m);
        const auto in_cone = hn::Le(hn::Mul(of.across, cosine), hn::Mul(of.along, sine));
        const V side = hn::Max(hn::Zero(D()), hn::MulAdd(of.along, cosine, hn::Mul(of.across, sine)));
        return hn::Mul(range, hn::IfThenElse(in_cone, hn::Sqrt(m.dot(m)), side));
    }
};

// The least m · (x − apex) of the froxels: at each end of the slab at one of the section's corners.
template <class D>
HWY_INLINE hn::Vec<D> least_along(const FroxelLanes<D>& froxels, const Vectors<D>& apex, const Vectors<D>& m) {
    const D d;
    const auto at = [&](hn::Vec<D> w) HWY_ATTR {
        const auto u = hn::Min(hn::Mul(m.u, hn::Sub(froxels.column(0, w), apex.u)),
                               hn::Mul(m.u, hn::Sub(froxels.column(1, w), apex.u)));
        const auto v =
            hn::Min(hn::Mul(m.v, hn::Sub(froxels.row(0, w), apex.v)), hn::Mul(m.v, hn::Sub(froxels.row(1, w), apex.v)));
        return hn::Add(hn::MulAdd(m.w, hn::Sub(w, apex.w), u), v);
    };
    return hn::Min(at(hn::Set(d, froxels.low)), at(hn::Set(d, froxels.high)));
}

// By projecting onto froxel and sector in turn, and a little beyond the sector's surface. A point of the froxel that is
// well inside the sector proves one answer. A direction m that the whole froxel is further along than the sector proves
// the other: both sides, along three axes, are off by less than 4 δ |m|, and η ≥ 8 δ.
template <class D>
HWY_INLINE Lit<D> test_spot(const FroxelLanes<D>& froxels, const FilterLight<hn::TFromD<D>>& light, int rounds) {
    using V = hn::Vec<D>;
    const D d;
    const Sector<D> sector(light);
    const Vectors<D> apex{hn::Set(d, light.at[0]), hn::Set(d, light.at[1]), hn::Set(d, light.at[2])};
    const V low = hn::Set(d, froxels.low), high = hn::Set(d, froxels.high), half = hn::Set(d, hn::TFromD<D>(0.5));
    // A point well inside: that of the largest ball.
    const V inside = hn::Div(sector.range, hn::Add(hn::Set(d, hn::TFromD<D>(1)), sector.sine));
    const Vectors<D> center{hn::Mul(sector.axis.u, inside), hn::Mul(sector.axis.v, inside),
                            hn::Mul(sector.axis.w, inside)};
    Lit<D> lit = test_ball(froxels, light);
    lit.yes = hn::FirstN(d, 0);  // of the ball of its range
    if (hn::AllTrue(d, lit.no)) return lit;
    const V middle = hn::Mul(half, hn::Add(low, high));
    Vectors<D> x{hn::Mul(half, hn::Add(froxels.column(0, middle), froxels.column(1, middle))),
                 hn::Mul(half, hn::Add(froxels.row(0, middle), froxels.row(1, middle))), middle};
    for (int round = 0;; ++round) {
        V w = hn::Max(low, hn::Min(high, x.w));
        w = NearestAt<D>(froxels, x.u, x.v, x.w, w).next(low, high);
        w = NearestAt<D>(froxels, x.u, x.v, x.w, w).next(low, high);
        const NearestAt<D> p(froxels, x.u, x.v, x.w, w);
        const Vectors<D> y{hn::Sub(p.u, apex.u), hn::Sub(p.v, apex.v), hn::Sub(p.w, apex.w)};
        const auto split = sector.split(y);
        lit.yes = hn::Or(lit.yes, sector.contains(y, split));
        const Vectors<D> q = sector.nearest(y, split), m = y.plus(q, hn::Set(d, hn::TFromD<D>(-1)));
        const V gap = hn::Sub(least_along(froxels, apex, m), sector.reach(m));
        lit.no = hn::Or(lit.no, hn::Gt(gap, hn::Mul(sector.eta, hn::Sqrt(m.dot(m)))));
        if (round == rounds || hn::AllTrue(d, hn::Or(lit.yes, lit.no))) return lit;
        // Beyond the surface, in every second round towards the middle by less and less.
        const hn::TFromD<D> share = round & 1 ? hn::TFromD<D>(0.5) / hn::TFromD<D>(1 + round % 32) : 0;
        const Vectors<D> inward = center.plus(q, hn::Set(d, hn::TFromD<D>(-1)));
        const Vectors<D> target = q.plus(m, hn::Set(d, hn::TFromD<D>(-0.6))).plus(inward, hn::Set(d, share));
        x = apex.plus(target, hn::Set(d, hn::TFromD<D>(1)));
    }
}

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
