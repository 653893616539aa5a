// SPDX-License-Identifier: MIT
#include "exact/cell_kernels.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <crofton/simd/compress-inl.hpp>

HWY_BEFORE_NAMESPACE();
namespace crofton::fit::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
namespace simd = crofton::simd::HWY_NAMESPACE;
using CellTag = hn::CappedTag<double, kBatch>;
using V = hn::Vec<CellTag>;

// Products and sums are rounded one by one (no fused operations), so that every instruction set gives the same bits.
struct V3 {
    V x, y, z;
};

HWY_INLINE V splat(double value) {
    return hn::Set(CellTag(), value);
}
HWY_INLINE V3 operator+(const V3& a, const V3& b) {
    return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE V3 operator-(const V3& a, const V3& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE V3 scaled(const V3& a, V s) {
    return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)};
}
HWY_INLINE V3 product(const V3& a, const V3& b) {
    return {hn::Mul(a.x, b.x), hn::Mul(a.y, b.y), hn::Mul(a.z, b.z)};
}
HWY_INLINE V dot(const V3& a, const V3& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE V3 absolute(const V3& a) {
    return {hn::Abs(a.x), hn::Abs(a.y), hn::Abs(a.z)};
}
HWY_INLINE V3 cross(const V3& a, const V3& b) {
    return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
            hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}

struct Frame {
    V3 axis[3];
};

// The rotation with Rodrigues vector c (direction of the axis, tangent of half the angle).
HWY_INLINE Frame rotation(const V3& c) {
    const V one = splat(1.0), two = splat(2.0);
    const V xx = hn::Mul(c.x, c.x), yy = hn::Mul(c.y, c.y), zz = hn::Mul(c.z, c.z);
    const V scale = hn::Div(one, hn::Add(one, hn::Add(hn::Add(xx, yy), zz)));
    const V twice = hn::Mul(two, scale);
    const V xy = hn::Mul(c.x, c.y), yz = hn::Mul(c.y, c.z), zx = hn::Mul(c.z, c.x);
    Frame f;
    f.axis[0] = {hn::Mul(hn::Sub(hn::Add(one, xx), hn::Add(yy, zz)), scale), hn::Mul(hn::Add(xy, c.z), twice),
                 hn::Mul(hn::Sub(zx, c.y), twice)};
    f.axis[1] = {hn::Mul(hn::Sub(xy, c.z), twice), hn::Mul(hn::Sub(hn::Add(one, yy), hn::Add(xx, zz)), scale),
                 hn::Mul(hn::Add(yz, c.x), twice)};
    f.axis[2] = {hn::Mul(hn::Add(zx, c.y), twice), hn::Mul(hn::Sub(yz, c.x), twice),
                 hn::Mul(hn::Sub(hn::Add(one, zz), hn::Add(xx, yy)), scale)};
    return f;
}

HWY_INLINE V3 to_frame(const Frame& f, const V3& p) {
    return {dot(f.axis[0], p), dot(f.axis[1], p), dot(f.axis[2], p)};
}

template <bool kGreatest>
HWY_INLINE V3 extreme(const V3& axis, const double* x, const double* y, const double* z, std::size_t count) {
    V3 best = {splat(x[0]), splat(y[0]), splat(z[0])};
    V height = dot(axis, best);
    for (std::size_t i = 1; i < count; ++i) {
        const V3 p = {splat(x[i]), splat(y[i]), splat(z[i])};
        const V t = dot(axis, p);
        const auto better = kGreatest ? hn::Gt(t, height) : hn::Lt(t, height);
        height = kGreatest ? hn::Max(height, t) : hn::Min(height, t);
        best = {hn::IfThenElse(better, p.x, best.x), hn::IfThenElse(better, p.y, best.y),
                hn::IfThenElse(better, p.z, best.z)};
    }
    return best;
}

HWY_INLINE void find_supports(const Frame& f, const SideLists& lists, V3* out) {
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t up = 2 * k, down = up + 1;
        out[up] = extreme<true>(f.axis[k], lists.x[up], lists.y[up], lists.z[up], lists.count[up]);
        out[down] = extreme<false>(f.axis[k], lists.x[down], lists.y[down], lists.z[down], lists.count[down]);
    }
}

// The quantities of a cell that its lower bound uses (docs/notes/fit.md derives it).
struct Geometry {
    V3 center, half;
    V3 tilt;  // bound of |components| of t, the half-angle tangent vector of a turn from the centre, in its frame
    V rate;   // bound of κ: sin(angle)·axis = κ·(δ − c × δ)
};

HWY_INLINE Geometry geometry(const V3& c, const V3& r) {
    const V one = splat(1.0), zero = splat(0.0);
    const V3 a = absolute(c);
    const V s = hn::Add(one, dot(c, c)), spread = dot(a, r);
    const V3 nearest = {hn::Max(zero, hn::Sub(a.x, r.x)), hn::Max(zero, hn::Sub(a.y, r.y)),
                        hn::Max(zero, hn::Sub(a.z, r.z))};
    Geometry g;
    g.center = c;
    g.half = r;
    g.rate = hn::Div(hn::Mul(splat(2.0), hn::Add(s, spread)), hn::Mul(s, hn::Add(one, dot(nearest, nearest))));
    const V inverse = hn::Div(one, hn::Sub(s, spread));
    g.tilt = {hn::Mul(hn::Add(r.x, hn::Add(hn::Mul(a.y, r.z), hn::Mul(a.z, r.y))), inverse),
              hn::Mul(hn::Add(r.y, hn::Add(hn::Mul(a.z, r.x), hn::Mul(a.x, r.z))), inverse),
              hn::Mul(hn::Add(r.z, hn::Add(hn::Mul(a.x, r.y), hn::Mul(a.y, r.x))), inverse)};
    return g;
}

// The rate at which dot(d, axis k) changes under a turn, e_k × d, as a linear form in δ, scaled by the cell's size.
HWY_INLINE V3 torque(const Geometry& g, std::size_t k, const V3& d) {
    const V zero = splat(0.0);
    const V3 t = k == 0   ? V3{zero, hn::Neg(d.z), d.y}
                 : k == 1 ? V3{d.z, zero, hn::Neg(d.x)}
                          : V3{hn::Neg(d.y), d.x, zero};
    return scaled(product(t + cross(g.center, t), g.half), g.rate);
}

struct Splat {
    V product, pairs, sum;
};

HWY_INLINE V value_of(const Splat& w, V a, V b, V c) {
    const V ab = hn::Mul(a, b);
    const V pairs = hn::Add(hn::Add(ab, hn::Mul(b, c)), hn::Mul(c, a));
    return hn::Add(hn::Add(hn::Mul(w.product, hn::Mul(ab, c)), hn::Mul(w.pairs, pairs)),
                   hn::Mul(w.sum, hn::Add(hn::Add(a, b), c)));
}

// The derivative by the first width, at the other two.
HWY_INLINE V slope(const Splat& w, V b, V c) {
    return hn::Add(hn::Add(hn::Mul(w.product, hn::Mul(b, c)), hn::Mul(w.pairs, hn::Add(b, c))), w.sum);
}

HWY_INLINE V sum_of(const V3& a) {
    return hn::Add(hn::Add(a.x, a.y), a.z);
}

// A lower bound of the value over the cell. Chord d[k] is a difference of points (or of mixtures of points) of opposite
// sides, in the centre's frame. The width along a turned axis is at least the chord's extent along it.
HWY_INLINE V lower_bound(const Splat& w, const Geometry& g, const V3 d[3]) {
    const V zero = splat(0.0), two = splat(2.0);
    const V tilt[3] = {g.tilt.x, g.tilt.y, g.tilt.z};
    V width[3], change[3];
    V3 gradient[3];
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
        const V e[3] = {d[k].x, d[k].y, d[k].z};
        const V sideways = hn::Mul(tilt[k], hn::Add(hn::Mul(hn::Abs(e[a]), tilt[a]), hn::Mul(hn::Abs(e[b]), tilt[b])));
        const V along = hn::Mul(hn::Max(e[k], zero), hn::Add(hn::Mul(tilt[a], tilt[a]), hn::Mul(tilt[b], tilt[b])));
        width[k] = hn::Sub(e[k], hn::Mul(two, hn::Add(sideways, along)));
        gradient[k] = torque(g, k, d[k]);
        change[k] = sum_of(absolute(gradient[k]));
    }
    V floor[3];
    auto valid = hn::Ge(hn::Sub(width[0], change[0]), zero);
    for (std::size_t k = 0; k < 3; ++k) {
        const V least = hn::Sub(width[k], change[k]);
        valid = hn::And(valid, hn::Ge(least, zero));
        floor[k] = hn::Max(zero, least);
    }
    const V apart = value_of(w, floor[0], floor[1], floor[2]);
    V3 g_sum = scaled(gradient[0], slope(w, width[1], width[2]));
    g_sum = g_sum + scaled(gradient[1], slope(w, width[2], width[0]));
    g_sum = g_sum + scaled(gradient[2], slope(w, width[0], width[1]));
    V joint = hn::Sub(value_of(w, width[0], width[1], width[2]), sum_of(absolute(g_sum)));
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
        const V mixed = hn::Add(hn::Mul(w.product, width[k]), w.pairs);
        joint = hn::Sub(joint, hn::Mul(mixed, hn::Mul(change[a], change[b])));
    }
    joint = hn::Sub(joint, hn::Mul(w.product, hn::Mul(hn::Mul(change[0], change[1]), change[2])));
    return hn::IfThenElse(valid, hn::Max(apart, joint), apart);
}

// argmax over t in [0, 1] of rise·t − |G + t·D|, the concave dual along one direction.
HWY_INLINE V best_step(V rise, const V3& G, const V3& D) {
    const V zero = splat(0.0), one = splat(1.0);
    const V A = dot(D, D), B = dot(G, D), C = dot(G, G);
    const V root = hn::Sqrt(A), inverse = hn::Div(one, hn::Max(root, splat(1e-300)));
    const V x = hn::Mul(rise, inverse);
    const V along = hn::Mul(B, inverse);
    const V away = hn::Sqrt(hn::Max(zero, hn::Sub(C, hn::Mul(along, along))));
    const V rest = hn::Sqrt(hn::Max(splat(1e-30), hn::Sub(one, hn::Mul(x, x))));
    V t = hn::Mul(hn::Sub(hn::Div(hn::Mul(x, away), rest), along), inverse);
    t = hn::Min(one, hn::Max(zero, t));
    t = hn::IfThenElse(hn::Ge(x, one), one, t);
    t = hn::IfThenElse(hn::Le(x, splat(-1.0)), zero, t);
    return hn::IfThenElse(hn::Gt(A, splat(1e-290)), t, zero);
}

HWY_INLINE void chords(const Frame& f, const V3 points[6], V3 d[3]) {
    for (std::size_t k = 0; k < 3; ++k) d[k] = to_frame(f, points[2 * k] - points[2 * k + 1]);
}

constexpr int kCuts = 3;  // more rarely pay: see docs/notes/fit.md

// Raises the bound by cutting planes: finds the turn where the current bound is least, takes the support points there,
// and mixes them into the chords by the amount that raises the bound most.
HWY_INLINE V improve(const Splat& w, const SideLists& lists, const Geometry& g, const Frame& f, V3 mix[6], V bound,
                     double target) {
    V3 cut[kCuts][6];
    for (int round = 0; round < kCuts; ++round) {
        if (hn::AllTrue(CellTag(), hn::Ge(bound, splat(target)))) break;
        V3 d[3];
        chords(f, mix, d);
        const V factor[3] = {slope(w, d[1].y, d[2].z), slope(w, d[2].z, d[0].x), slope(w, d[0].x, d[1].y)};
        V3 G = scaled(torque(g, 0, d[0]), factor[0]);
        G = G + scaled(torque(g, 1, d[1]), factor[1]);
        G = G + scaled(torque(g, 2, d[2]), factor[2]);
        const V length = hn::Sqrt(hn::Max(splat(1e-300), dot(G, G)));
        const V3 least = g.center - product(scaled(G, hn::Div(splat(1.0), length)), g.half);
        find_supports(rotation(least), lists, cut[round]);
        for (int c = round; c >= 0; --c)
            for (std::size_t side = 0; side < 6; ++side) {
                const std::size_t k = side / 2;
                const V sign = splat(side % 2 == 0 ? 1.0 : -1.0);
                const V3 step = cut[c][side] - mix[side];
                const V3 local = to_frame(f, step);
                const V weight = hn::Mul(sign, factor[k]);
                const V rise = hn::Mul(weight, k == 0 ? local.x : k == 1 ? local.y : local.z);
                const V3 D = scaled(torque(g, k, local), weight);
                const V t = best_step(rise, G, D);
                G = G + scaled(D, t);
                mix[side] = mix[side] + scaled(step, t);
            }
        chords(f, mix, d);
        bound = hn::Max(bound, lower_bound(w, g, d));
    }
    return bound;
}

// How fast the value may change with each coordinate of δ; decides where to split. A tenth of a width is added for
// turns about the other axes, for the terms of second order.
HWY_INLINE V3 variation(const Splat& w, const Geometry& g, const V3 d[3]) {
    const V width[3] = {d[0].x, d[1].y, d[2].z};
    V sum[3] = {splat(0.0), splat(0.0), splat(0.0)};
    const V half[3] = {g.half.x, g.half.y, g.half.z};
    for (std::size_t k = 0; k < 3; ++k) {
        const V factor = slope(w, width[(k + 1) % 3], width[(k + 2) % 3]);
        const V3 t = absolute(torque(g, k, d[k]));
        const V first[3] = {t.x, t.y, t.z};
        const V second = hn::Mul(splat(0.1), width[k]);
        for (std::size_t j = 0; j < 3; ++j)
            sum[j] =
                hn::Add(sum[j], hn::Mul(factor, hn::Add(hn::Div(first[j], half[j]), j == k ? splat(0.0) : second)));
    }
    return {sum[0], sum[1], sum[2]};
}

void evaluate_cells(const Weights& weights, const SideLists& lists, double target, CellBatch& batch) {
    const CellTag tag;
    const Splat w = {splat(weights.product), splat(weights.pairs), splat(weights.sum)};
    for (std::size_t i = 0; i < kBatch; i += hn::Lanes(tag)) {
        const V3 c = {hn::Load(tag, batch.center[0] + i), hn::Load(tag, batch.center[1] + i),
                      hn::Load(tag, batch.center[2] + i)};
        const V3 r = {splat(batch.half.x), splat(batch.half.y), splat(batch.half.z)};
        const Geometry g = geometry(c, r);
        const Frame f = rotation(c);
        V3 mix[6];
        find_supports(f, lists, mix);
        for (std::size_t side = 0; side < 6; ++side) {
            hn::Store(mix[side].x, tag, batch.support[side][0] + i);
            hn::Store(mix[side].y, tag, batch.support[side][1] + i);
            hn::Store(mix[side].z, tag, batch.support[side][2] + i);
        }
        V3 d[3];
        chords(f, mix, d);
        hn::Store(value_of(w, d[0].x, d[1].y, d[2].z), tag, batch.value + i);
        const V3 spread = variation(w, g, d);
        hn::Store(spread.x, tag, batch.spread[0] + i);
        hn::Store(spread.y, tag, batch.spread[1] + i);
        hn::Store(spread.z, tag, batch.spread[2] + i);
        hn::Store(g.tilt.x, tag, batch.tilt[0] + i);
        hn::Store(g.tilt.y, tag, batch.tilt[1] + i);
        hn::Store(g.tilt.z, tag, batch.tilt[2] + i);
        const V bound = improve(w, lists, g, f, mix, lower_bound(w, g, d), target);
        hn::Store(bound, tag, batch.bound + i);
    }
}

std::size_t filter_list(const SideLists& lists, std::size_t side, const CellBatch& batch, std::size_t cell,
                        const ListOut& out) {
    const CellTag tag;
    const std::size_t k = side / 2, a = (k + 1) % 3, b = (k + 2) % 3, count = lists.count[side];
    const Frame f =
        rotation({splat(batch.center[0][cell]), splat(batch.center[1][cell]), splat(batch.center[2][cell])});
    const V3 support = {splat(batch.support[side][0][cell]), splat(batch.support[side][1][cell]),
                        splat(batch.support[side][2][cell])};
    const V ta = splat(batch.tilt[a][cell]), tb = splat(batch.tilt[b][cell]), tk = splat(batch.tilt[k][cell]);
    const V squares = hn::Add(hn::Mul(ta, ta), hn::Mul(tb, tb));
    const V two = splat(2.0), sign = splat(side % 2 == 0 ? 1.0 : -1.0);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; i += hn::Lanes(tag)) {
        // Reads past the list's end: lists are followed by at least one vector of readable memory.
        const V3 p = {hn::LoadU(tag, lists.x[side] + i), hn::LoadU(tag, lists.y[side] + i),
                      hn::LoadU(tag, lists.z[side] + i)};
        const V3 step = p - support;
        const V along = dot(f.axis[k], step);
        const V da = hn::Abs(dot(f.axis[a], step)), db = hn::Abs(dot(f.axis[b], step));
        // Turning by t moves dot(step, axis k) by at most 2(t_b|a| + t_a|b|) + 2t_k(t_a|a| + t_b|b|) + 2|k|(t_a² +
        // t_b²).
        V most = hn::Add(hn::Mul(tb, da), hn::Mul(ta, db));
        most = hn::Add(most, hn::Mul(tk, hn::Add(hn::Mul(ta, da), hn::Mul(tb, db))));
        most = hn::Add(most, hn::Mul(hn::Abs(along), squares));
        const V highest = hn::Add(hn::Mul(sign, along), hn::Mul(two, most));
        auto keep = hn::Ge(highest, splat(-1e-15));
        keep = hn::And(keep, hn::FirstN(tag, count - i));
        simd::compress_store(tag, p.x, keep, out.x + kept);
        simd::compress_store(tag, p.y, keep, out.y + kept);
        kept += simd::compress_store(tag, p.z, keep, out.z + kept);
    }
    return kept;
}

}  // namespace crofton::fit::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::fit::kernels {

HWY_EXPORT(evaluate_cells);
HWY_EXPORT(filter_list);

void evaluate_cells(const Weights& weights, const SideLists& lists, double target, CellBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evaluate_cells)(weights, lists, target, batch);
}

std::size_t filter_list(const SideLists& lists, std::size_t side, const CellBatch& batch, std::size_t cell,
                        const ListOut& out) {
    return HWY_DYNAMIC_DISPATCH(filter_list)(lists, side, batch, cell, out);
}

}  // namespace crofton::fit::kernels
#endif
