// SPDX-License-Identifier: MIT
// Tests eight pairs of triangles for overlap, in a's frame and in double. Included once per instruction set.
#if defined(CROFTON_COLLIDE_TRIANGLE_PAIRS) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_COLLIDE_TRIANGLE_PAIRS
#undef CROFTON_COLLIDE_TRIANGLE_PAIRS
#else
#define CROFTON_COLLIDE_TRIANGLE_PAIRS
#endif

#include <hwy/highway.h>

#include "double_lanes-inl.hpp"
#include "mesh_pair.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::mesh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr double kUnderflow = 1e-280;

// Gathered from wherever candidates are found, so that no lane is idle. Vertices [v][i] as exact arithmetic sees them.
struct TrianglePairs {
    alignas(64) double a[3][3][mesh::kMeshLeafWidth] = {};
    alignas(64) double b[3][3][mesh::kMeshLeafWidth] = {};
    LeafTriangle of_a[mesh::kMeshLeafWidth], of_b[mesh::kMeshLeafWidth];
    std::uint32_t count = 0;
};

// An upper bound of |w|₁ for the difference w of any two of the six points; the factor covers the rounding of the sums.
HWY_INLINE VD l1_extent_of(DD d, const VD (&a)[3][3], const VD (&b)[3][3]) {
    VD l1_extent = hn::Zero(d);
    for (int i = 0; i < 3; ++i) {
        const VD low =
            hn::Min(hn::Min(a[0][i], hn::Min(a[1][i], a[2][i])), hn::Min(b[0][i], hn::Min(b[1][i], b[2][i])));
        const VD high =
            hn::Max(hn::Max(a[0][i], hn::Max(a[1][i], a[2][i])), hn::Max(b[0][i], hn::Max(b[1][i], b[2][i])));
        l1_extent = hn::Add(l1_extent, hn::Sub(high, low));
    }
    return hn::Mul(l1_extent, hn::Set(d, 1.0000001));
}

// Determinants whose signs say on which side of a plane three points lie.
struct Sides {
    VD value[3];
    VD error;
};

// Of p's points, of the plane of q.
HWY_INLINE Sides sides_of(DD d, const VD (&q)[3][3], const VD (&p)[3][3], VD l1_extent) {
    VD u[3], v[3], normal[3];
    for (int i = 0; i < 3; ++i) {
        u[i] = hn::Sub(q[1][i], q[0][i]);
        v[i] = hn::Sub(q[2][i], q[0][i]);
    }
    cross(u, v, normal);
    Sides sides;
    sides.error = hn::MulAdd(hn::Mul(l1_extent, hn::Set(d, kDeterminantError)), hn::Mul(sum_abs(u), sum_abs(v)),
                             hn::Set(d, kUnderflow));
    for (int k = 0; k < 3; ++k) {
        VD w[3];
        for (int i = 0; i < 3; ++i) w[i] = hn::Sub(p[k][i], q[0][i]);
        sides.value[k] = dot(normal, w);
    }
    return sides;
}

HWY_INLINE MD all_on_one_side(const Sides& s) {
    const VD low = hn::Min(s.value[0], hn::Min(s.value[1], s.value[2])),
             high = hn::Max(s.value[0], hn::Max(s.value[1], s.value[2]));
    return hn::Or(hn::Gt(low, s.error), hn::Lt(high, hn::Neg(s.error)));
}

// How far the nearest of the three values is beyond its error bound; the signs are certain iff this is positive.
HWY_INLINE VD certainty(const VD* value, const VD* error) {
    const auto margin = [&](int k) HWY_ATTR { return hn::Sub(hn::Abs(value[k]), error[k]); };
    return hn::Min(margin(0), hn::Min(margin(1), margin(2)));
}

// In the sign bit: an edge pierces a triangle iff its ends lie apart from the plane and its determinants with the three
// edges agree in sign.
HWY_INLINE VD pierces(VD end, VD other_end, VD x, VD y, VD z) {
    return hn::AndNot(hn::Or(hn::Xor(x, y), hn::Xor(y, z)), hn::Xor(end, other_end));
}

// Where all signs are certain two triangles meet iff an edge of one pierces the other. The nine determinants of an edge
// of each serve both directions.
HWY_INLINE void judge_lanes(DD d, const TrianglePairs& pairs, std::size_t l, LaneVerdict& verdict) {
    VD a[3][3], b[3][3];
    for (int v = 0; v < 3; ++v)
        for (int i = 0; i < 3; ++i) {
            a[v][i] = hn::Load(d, pairs.a[v][i] + l);
            b[v][i] = hn::Load(d, pairs.b[v][i] + l);
        }
    const VD l1_extent = l1_extent_of(d, a, b);
    const Sides of_a = sides_of(d, b, a, l1_extent), of_b = sides_of(d, a, b, l1_extent);
    const MD apart = hn::Or(all_on_one_side(of_a), all_on_one_side(of_b));
    if (hn::AllTrue(d, apart)) return;
    VD along_b[3][3], size_b[3];
    const VD scale = hn::Mul(l1_extent, hn::Set(d, kDeterminantError));
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) along_b[j][i] = hn::Sub(b[(j + 1) % 3][i], b[j][i]);
        size_b[j] = hn::Mul(sum_abs(along_b[j]), scale);
    }
    const VD error_a[3] = {of_a.error, of_a.error, of_a.error}, error_b[3] = {of_b.error, of_b.error, of_b.error};
    VD certain = hn::Min(certainty(of_a.value, error_a), certainty(of_b.value, error_b));
    VD value[3][3];  // [edge of a][edge of b]
    VD pierced[6];   // by the edges of a, then of b: in the sign bits
    for (int e = 0; e < 3; ++e) {
        const int f = (e + 1) % 3;
        VD along_a[3], error[3];
        for (int i = 0; i < 3; ++i) along_a[i] = hn::Sub(a[f][i], a[e][i]);
        const VD length = sum_abs(along_a);
        for (int j = 0; j < 3; ++j) {
            VD n[3], w[3];
            cross(along_a, along_b[j], n);
            for (int i = 0; i < 3; ++i) w[i] = hn::Sub(b[j][i], a[e][i]);
            value[e][j] = dot(n, w);
            error[j] = hn::MulAdd(size_b[j], length, hn::Set(d, kUnderflow));
        }
        certain = hn::Min(certain, certainty(value[e], error));
        pierced[e] = pierces(of_a.value[e], of_a.value[f], value[e][0], value[e][1], value[e][2]);
    }
    for (int j = 0; j < 3; ++j)
        pierced[3 + j] = pierces(of_b.value[j], of_b.value[(j + 1) % 3], value[0][j], value[1][j], value[2][j]);
    const MD sure = hn::Gt(certain, hn::Zero(d));
    const hn::RebindToSigned<DD> di;
    const MD decided = hn::AndNot(apart, sure);
    verdict.open |= bits_of(d, hn::Not(hn::Or(apart, sure)), l);
    for (int e = 0; e < 6; ++e) {
        const MD through = hn::RebindMask(d, hn::Lt(hn::BitCast(di, pierced[e]), hn::Zero(di)));
        verdict.pierced[e] |= bits_of(d, hn::And(decided, through), l);
    }
}

// Pairs that surely meet, and pairs that need exact arithmetic.
HWY_INLINE LaneVerdict judge(const TrianglePairs& pairs) {
    const DD d;
    LaneVerdict verdict;
    for (std::size_t l = 0; l < mesh::kMeshLeafWidth; l += hn::Lanes(d))
        if (l < pairs.count) judge_lanes(d, pairs, l, verdict);
    const std::uint32_t used = (1u << pairs.count) - 1u;
    verdict.open &= used;
    for (std::uint32_t& lanes : verdict.pierced) {
        lanes &= used;
        verdict.hits |= lanes;
    }
    return verdict;
}

}  // namespace crofton::mesh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
