// SPDX-License-Identifier: MIT
// The separating-axis test on sixteen pairs of boxes at once, compiled for each instruction set and chosen at run time.
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include <hwy/highway.h>
#include <crofton/simd/mask_bits-inl.hpp>

#include "block_filter.hpp"

// The error bound. Let δ be the largest |axes[i]·axes[j] − δij| of a box, S = |T|₁ + Σ half extents of both, u = 2^-24.
// Rounding: T, its products with axes and with R, and the radii go through at most 16 roundings each, so 32 u S covers
// both sides of a comparison. Axes: with A and B the matrices of axes, R = AᵀB and C the cofactors of R, |C − ±R| ≤ 7.5
// (δa + δb), since RᵀR is off the identity by at most 3 (δa + δb) in norm; the cross product of two stored axes is off
// the third by at most 7.5 δ. Both the directions tested and the radii used therefore differ from the exact test's by
// less than 32 (δa + δb) in each coefficient: a gap beyond ± (32 u + 32 (δa + δb)) S has its sign for certain. What
// underflows is below 1e-36.
//
// Nearly parallel edges a and b, of sine s: their cross product is short, and its gap is lost in the error. But it
// cannot separate boxes that overlap along all face normals by more than 2.5 s S, gaps taken along unit vectors. Let n
// be the unit vector along a × b. Project to the plane across a, which holds n, all edges but a and b. The gap along n
// is that of the offset and the zonogon Z of these four, for n·a = n·b = 0. If the offset lies in Z, at least g within
// each of its sides' lines, it is at least g within along every direction, n too. The normals of Z's sides are m = a ×
// c for the four edges c. For an edge c of a's box m is its face normal, and leaving b out costs at most s · half of b.
// For an edge c of b's box the face normal f = b × c is within 2.05 s of m (|a − b| ≤ s / cos(angle / 2); where the
// angle is not small the bound says nothing), which changes the gap by at most 2.05 s for each half length and the
// offset; a, which is left out, counts |f·a| ≤ s, and f·b = 0. s is at most the sum of b's components along the other
// two axes of a's box, + 3 δa + rounding: two entries of R. The rest of 2.5, and that the error's share of S is added
// to s, cover that axes and normals are of unit length within 8 (δa + δb) only.
HWY_BEFORE_NAMESPACE();
namespace crofton::collide::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace simd = crofton::simd::HWY_NAMESPACE;

using D = hn::CappedTag<float, kBoxBlock>;
using V = hn::Vec<D>;

HWY_INLINE V dot3(V ax, V ay, V az, V bx, V by, V bz) {
    return hn::MulAdd(ax, bx, hn::MulAdd(ay, by, hn::Mul(az, bz)));
}

HWY_INLINE V sum_abs(V x, V y, V z) {
    return hn::Add(hn::Abs(x), hn::Add(hn::Abs(y), hn::Abs(z)));
}

HWY_INLINE void put_bits(D d, hn::Mask<D> mask, std::size_t lane, std::uint32_t& bits) {
    bits |= simd::mask_bits(d, mask) << lane;
}

HWY_INLINE void filter_lanes(D d, const BoxBlock& a, const BoxBlock& b, std::size_t l, BlockVerdict& verdict) {
    const auto at = [&](const float* row) HWY_ATTR { return hn::Load(d, row + l); };
    const V cx = at(b.center[0]), cy = at(b.center[1]), cz = at(b.center[2]);  // from a's
    V t[3], r[3][3], m[3][3], ha[3], hb[3];
    for (int k = 0; k < 3; ++k) {
        ha[k] = at(a.half[k]);
        hb[k] = at(b.half[k]);
    }
    for (int i = 0; i < 3; ++i) {
        const V ax = at(a.axes[i][0]), ay = at(a.axes[i][1]), az = at(a.axes[i][2]);
        t[i] = dot3(ax, ay, az, cx, cy, cz);
        for (int j = 0; j < 3; ++j) {
            r[i][j] = dot3(ax, ay, az, at(b.axes[j][0]), at(b.axes[j][1]), at(b.axes[j][2]));
            m[i][j] = hn::Abs(r[i][j]);
        }
    }
    const V size = hn::Add(sum_abs(cx, cy, cz), hn::Add(sum_abs(ha[0], ha[1], ha[2]), sum_abs(hb[0], hb[1], hb[2])));
    const V share =
        hn::MulAdd(hn::Add(at(a.deviation), at(b.deviation)), hn::Set(d, kPerDeviation), hn::Set(d, kRounding));
    const V error = hn::MulAdd(size, share, hn::Set(d, 1e-36f));

    V face_a = hn::Set(d, -1e38f), face_b = face_a, edges = face_a;
    for (int i = 0; i < 3; ++i) {
        const V radius_b = hn::Add(ha[i], dot3(hb[0], hb[1], hb[2], m[i][0], m[i][1], m[i][2]));
        face_a = hn::Max(face_a, hn::Sub(hn::Abs(t[i]), radius_b));
        const V radius_a = hn::Add(hb[i], dot3(ha[0], ha[1], ha[2], m[0][i], m[1][i], m[2][i]));
        const V along = hn::Abs(dot3(t[0], t[1], t[2], r[0][i], r[1][i], r[2][i]));
        face_b = hn::Max(face_b, hn::Sub(along, radius_a));
    }
    const hn::Mask<D> by_a = hn::Gt(face_a, error), by_b = hn::Gt(face_b, error);
    put_bits(d, by_a, l, verdict.face_a);
    put_bits(d, hn::AndNot(by_a, by_b), l, verdict.face_b);
    const hn::Mask<D> by_faces = hn::Or(by_a, by_b);
    if (hn::AllTrue(d, by_faces)) return;
    const V shallow = hn::Max(face_a, face_b), per_sine = hn::Mul(size, hn::Set(d, kPerSine));
    const V least = hn::MulAdd(share, per_sine, shallow);
    V worst = shallow;
    for (int i = 0; i < 3; ++i) {
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        for (int j = 0; j < 3; ++j) {
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            const V along = hn::Abs(hn::NegMulAdd(t[i1], r[i2][j], hn::Mul(t[i2], r[i1][j])));
            const V projected_radius =
                hn::MulAdd(ha[i1], m[i2][j],
                           hn::MulAdd(ha[i2], m[i1][j], hn::MulAdd(hb[j1], m[i][j2], hn::Mul(hb[j2], m[i][j1]))));
            const V gap = hn::Sub(along, projected_radius);
            edges = hn::Max(edges, gap);
            const V parallel = hn::MulAdd(hn::Add(m[i1][j], m[i2][j]), per_sine, least);
            worst = hn::Max(worst, hn::Min(gap, parallel));
        }
    }
    put_bits(d, hn::AndNot(by_faces, hn::Gt(edges, error)), l, verdict.edges);
    put_bits(d, hn::Lt(worst, hn::Neg(error)), l, verdict.hit);
}

void FilterBlock(const BoxBlock& a, const BoxBlock& b, BlockVerdict& verdict) {
    const D d;
    for (std::size_t l = 0; l < kBoxBlock; l += hn::Lanes(d)) filter_lanes(d, a, b, l, verdict);
}

void MeasureDeviation(BoxBlock& block) {
    const D d;
    for (std::size_t l = 0; l < kBoxBlock; l += hn::Lanes(d)) {
        V worst = hn::Zero(d), poison = hn::Zero(d);
        for (int i = 0; i < 3; ++i)
            for (int j = i; j < 3; ++j) {
                const V x = hn::Load(d, block.axes[i][0] + l), y = hn::Load(d, block.axes[i][1] + l),
                        z = hn::Load(d, block.axes[i][2] + l);
                const V dot = dot3(x, y, z, hn::Load(d, block.axes[j][0] + l), hn::Load(d, block.axes[j][1] + l),
                                   hn::Load(d, block.axes[j][2] + l));
                const V off = hn::Abs(i == j ? hn::Sub(dot, hn::Set(d, 1.0f)) : dot);
                worst = hn::Max(worst, off);
                poison = hn::Add(poison, hn::Sub(off, off));  // Max may drop a NaN: keep it here
            }
        hn::Store(hn::Add(hn::Add(worst, poison), hn::Set(d, 2e-7f)), d, block.deviation + l);
    }
}

}  // namespace crofton::collide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::collide {

HWY_EXPORT(FilterBlock);
HWY_EXPORT(MeasureDeviation);

BlockVerdict filter_block(const BoxBlock& a, const BoxBlock& b) {
    BlockVerdict verdict;
    HWY_DYNAMIC_DISPATCH(FilterBlock)(a, b, verdict);
    return verdict;
}
void measure_deviation(BoxBlock& block) {
    HWY_DYNAMIC_DISPATCH(MeasureDeviation)(block);
}

}  // namespace crofton::collide
#endif
