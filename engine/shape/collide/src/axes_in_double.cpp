// SPDX-License-Identifier: MIT
// The fifteen axes of one pair of boxes in double, compiled for each instruction set and chosen at run time.
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include <hwy/highway.h>

#include "pair_columns.hpp"
#include "three_lanes-inl.hpp"

// The test of obb_obb.cpp with N_l = a_{l+1} × a_{l+2} and M_l = b_{l+1} × b_{l+2}, the face normals, and T the offset:
//     face l of a:   |N_l·T| − h_l |N_l·a_l| − Σ_j g_j |N_l·b_j|,   h and g the half extents of a and b; b likewise
//     edges i, j:    |(T × a_i)·b_j| − h_{i+1} |N_{i+2}·b_j| − h_{i+2} |N_{i+1}·b_j| − g_{j+1} |M_{j+2}·a_i|
//                                    − g_{j+2} |M_{j+1}·a_i|
// for a_{i+1}·(a_i × b_j) = −N_{i+2}·b_j and so on: eighteen products of normals and edges serve all radii.
//
// The error, with u = 2^-53, S = |T|₁ + Σh + Σg, and axes no longer than 1 + 10^-4. Products of two floats are exact in
// double, so a normal has one rounding a component: |error of N·v| ≤ 4u |N| |v|, of h |N·v| ≤ 5.01 u h; adding the four
// terms of a projected radius and their differences makes 8.1 u Σ. T has one rounding, so N·T is off by at most 5.01 u
// |T|₁. T × a: 3u of its six products, which times b sum to at most |T|₁ |a| |b|; with the product and two sums 6.01 u
// |T|₁. The last subtraction adds u. Every gap is off by less than 10 u S; 16 u S covers the roundings of S itself.
// Underflow: 1e-300.
//
// No operation is fused, so the verdicts are the same on every machine. Boxes that are not finite never overlap along
// all axes: where T or an extent is not finite, neither is S; where a_1 is not, N_0·T is NaN or infinite, and gap 0 NaN
// or +inf.
HWY_BEFORE_NAMESPACE();
namespace crofton::collide::HWY_NAMESPACE {

struct Columns {
    Three x, y, z;
};

HWY_INLINE Columns columns(const float (&rows)[3][4]) {
    return {load3(rows[0]), load3(rows[1]), load3(rows[2])};
}
HWY_INLINE Columns next(const Columns& u) {
    return {next(u.x), next(u.y), next(u.z)};
}
HWY_INLINE Columns after_next(const Columns& u) {
    return {after_next(u.x), after_next(u.y), after_next(u.z)};
}
HWY_INLINE Three dot(const Columns& u, const Columns& v) {
    return u.x * v.x + u.y * v.y + u.z * v.z;
}
HWY_INLINE Columns cross(const Columns& u, const Columns& v) {
    return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

struct Gaps {
    Three gap[5];
    Three size;
};

HWY_INLINE Gaps gaps_of(const PairColumns& pair) {
    const Columns a[3] = {columns(pair.a), next(columns(pair.a)), after_next(columns(pair.a))};
    const Columns b[3] = {columns(pair.b), next(columns(pair.b)), after_next(columns(pair.b))};
    const Columns offset = {all3(pair.offset[0]), all3(pair.offset[1]), all3(pair.offset[2])};
    const Three ha = load3(pair.half_a), hb = load3(pair.half_b);
    const Three ha1 = next(ha), ha2 = after_next(ha), hb1 = next(hb), hb2 = after_next(hb);
    const Columns normal_a = cross(a[1], a[2]), normal_b = cross(b[1], b[2]), moment = cross(offset, a[0]);
    Three p[3], q[3];  // lane l of p[k]: |normal l of a · edge l + k of b|; of q[k]: |normal l of b · edge l + k of a|
    for (int k = 0; k < 3; ++k) {
        p[k] = magnitude(dot(normal_a, b[k]));
        q[k] = magnitude(dot(normal_b, a[k]));
    }
    const Three own_a = magnitude(dot(normal_a, a[0])) * ha, own_b = magnitude(dot(normal_b, b[0])) * hb;
    // |normal j of b · edge i of a| with j − i = 1, 2, in lanes i; for 0 it is q[0].
    const Three s1 = next(q[2]), s2 = after_next(q[1]);
    Gaps gaps = {
        {
            magnitude(dot(normal_a, offset)) - ((own_a + p[0] * hb) + (p[1] * hb1 + p[2] * hb2)),
            magnitude(dot(normal_b, offset)) - ((own_b + q[0] * ha) + (q[1] * ha1 + q[2] * ha2)),
            magnitude(dot(moment, b[0])) - ((ha1 * after_next(p[1]) + ha2 * next(p[2])) + (hb1 * s2 + hb2 * s1)),
            magnitude(dot(moment, b[1])) - ((ha1 * after_next(p[2]) + ha2 * next(p[0])) + (hb2 * q[0] + hb * s2)),
            magnitude(dot(moment, b[2])) - ((ha1 * after_next(p[0]) + ha2 * next(p[1])) + (hb * s1 + hb1 * q[0])),
        },
        {}};
    const Three h = ha + hb;
    gaps.size = (h + next(h) + after_next(h)) + (magnitude(offset.x) + magnitude(offset.y) + magnitude(offset.z));
    return gaps;
}

// Products of edges that are shorter are noise as directions.
constexpr double kLeastSquaredSine = 1e-12;

HWY_INLINE Three largest(const Three& u) {
    return larger(u, larger(next(u), after_next(u)));
}
HWY_INLINE int first_axis(std::uint32_t axes) {
    return axes == 0 ? 0 : static_cast<int>(hwy::Num0BitsBelowLS1Bit_Nonzero32(axes));
}

// What the gaps may be off by: the bound that gaps_of() derives, and what underflow eats.
HWY_INLINE Three rounding_of(const Gaps& gaps) {
    return gaps.size * all3(0x1p-49) + all3(1e-300);
}

void MeasureAxes(const PairColumns& pair, AxisMeasures& measures) {
    const Gaps gaps = gaps_of(pair);
    const Columns a[3] = {columns(pair.a), next(columns(pair.a)), after_next(columns(pair.a))};
    const Columns b[3] = {columns(pair.b), next(columns(pair.b)), after_next(columns(pair.b))};
    const Columns axes[5] = {cross(a[1], a[2]), cross(b[1], b[2]), cross(a[0], b[0]), cross(a[0], b[1]),
                             cross(a[0], b[2])};
    Three ratio[5];  // the signed square of the gap per length: as ordered as the gap itself
    for (int g = 0; g < 5; ++g) {
        const Three squared = dot(axes[g], axes[g]);
        store3(gaps.gap[g], measures.gap[g]);
        store3(squared, measures.squared_length[g]);
        ratio[g] = gaps.gap[g] * magnitude(gaps.gap[g]) / squared;
        if (g >= 2) ratio[g] = where_above(squared, kLeastSquaredSine, ratio[g], -1e300);
    }
    alignas(32) double size[4];
    store3(gaps.size, size);
    measures.size = size[0];
    const Three face = largest(larger(ratio[0], ratio[1]));
    const Three edge = largest(larger(ratio[2], larger(ratio[3], ratio[4])));
    const std::uint32_t faces[5] = {lanes_equal(ratio[0], face), lanes_equal(ratio[1], face), 0, 0, 0};
    const std::uint32_t edges[5] = {0, 0, lanes_equal(ratio[2], edge), lanes_equal(ratio[3], edge),
                                    lanes_equal(ratio[4], edge)};
    const bool has_edge = (lanes_below(all3(-1e300), edge) & 1u) != 0;
    measures.face = first_axis(axis_set(faces));
    measures.edge = has_edge ? first_axis(axis_set(edges)) : -1;
    measures.edge_is_widest = has_edge && (lanes_below(face, edge) & 1u) != 0;
    const Three error = rounding_of(gaps);
    measures.surely_meet = lanes_all_below(gaps.gap, all3(0.0) - error) == 7u;
    const Three widest =
        larger(larger(gaps.gap[0], gaps.gap[1]), larger(gaps.gap[2], larger(gaps.gap[3], gaps.gap[4])));
    measures.surely_apart = lanes_below(error, widest) != 0;
}

AxisVerdicts JudgeAxes(const PairColumns& pair) {
    const Gaps gaps = gaps_of(pair);
    const Three(&gap)[5] = gaps.gap;
    const Three error = rounding_of(gaps);
    const Three overlap = all3(0.0) - error;
    if (lanes_all_below(gap, overlap) == 7u) return {};
    std::uint32_t separated[5], overlapping[5];
    for (int g = 0; g < 5; ++g) {
        separated[g] = lanes_below(error, gap[g]);
        overlapping[g] = lanes_below(gap[g], overlap);
    }
    AxisVerdicts verdicts;
    verdicts.separated = axis_set(separated);
    verdicts.unknown = kAllAxes & ~(verdicts.separated | axis_set(overlapping));
    return verdicts;
}

}  // namespace crofton::collide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::collide {

HWY_EXPORT(JudgeAxes);
HWY_EXPORT(MeasureAxes);

AxisVerdicts judge_axes(const PairColumns& pair) {
    return HWY_DYNAMIC_DISPATCH(JudgeAxes)(pair);
}
void measure_axes(const PairColumns& pair, AxisMeasures& measures) {
    HWY_DYNAMIC_DISPATCH(MeasureAxes)(pair, measures);
}

}  // namespace crofton::collide
#endif
