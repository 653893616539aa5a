// SPDX-License-Identifier: MIT
// The triangles of two leaves in a's frame, and which of them may meet by their bounds; included once per instruction
// set.
#if defined(CROFTON_COLLIDE_LEAF_KERNELS) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_COLLIDE_LEAF_KERNELS
#undef CROFTON_COLLIDE_LEAF_KERNELS
#else
#define CROFTON_COLLIDE_LEAF_KERNELS
#endif

#include <hwy/highway.h>

#include "mesh_pair.hpp"
#include "triangle_pairs-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::mesh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Eight triangles with what the tests need of them, coordinates exactly those of the scalar code.
struct LeafLanes {
    alignas(64) double vertex[3][3][mesh::kMeshLeafWidth];
    alignas(64) double low[3][mesh::kMeshLeafWidth];
    alignas(64) double high[3][mesh::kMeshLeafWidth];
    alignas(64) double normal[3][mesh::kMeshLeafWidth];    // (v1 − v0) × (v2 − v0)
    alignas(64) double normal_size[mesh::kMeshLeafWidth];  // |v1 − v0|₁ |v2 − v0|₁
    double all_low[3], all_high[3];                        // of the whole leaf
    std::uint32_t leaf = ~std::uint32_t{0};                // whose lanes these are
};

// The same roundings as transform(RigidTransform) in pose.cpp: products and sums one by one, tiny results taken as
// zero.
HWY_INLINE void carry_over(DD d, const MeshPair& pair, VD* p) {
    VD out[3];
    for (int i = 0; i < 3; ++i) {
        const VD x = hn::Mul(hn::Set(d, pair.exact_rotation[i][0]), p[0]),
                 y = hn::Mul(hn::Set(d, pair.exact_rotation[i][1]), p[1]),
                 z = hn::Mul(hn::Set(d, pair.exact_rotation[i][2]), p[2]);
        const VD sum = hn::Add(hn::Add(hn::Add(x, y), z), hn::Set(d, pair.exact_translation[i]));
        out[i] = hn::IfThenZeroElse(hn::Lt(hn::Abs(sum), hn::Set(d, 1e-60)), sum);
    }
    for (int i = 0; i < 3; ++i) p[i] = out[i];
}

HWY_INLINE void store_planes(DD d, const VD (&w)[3][3], std::size_t l, LeafLanes& out) {
    VD u[3], v[3], normal[3];
    for (int i = 0; i < 3; ++i) {
        u[i] = hn::Sub(w[1][i], w[0][i]);
        v[i] = hn::Sub(w[2][i], w[0][i]);
    }
    cross(u, v, normal);
    for (int i = 0; i < 3; ++i) hn::Store(normal[i], d, out.normal[i] + l);
    hn::Store(hn::Mul(sum_abs(u), sum_abs(v)), d, out.normal_size + l);
}

HWY_INLINE void load_lanes(const MeshPair& pair, const mesh::MeshLeaf& leaf, bool of_b, LeafLanes& out) {
    const DD d;
    const hn::Rebind<float, DD> df;
    for (std::size_t l = 0; l < mesh::kMeshLeafWidth; l += hn::Lanes(d)) {
        VD w[3][3];
        for (int c = 0; c < 3; ++c) {
            for (int i = 0; i < 3; ++i) w[c][i] = hn::PromoteTo(d, hn::Load(df, leaf.vertex[c][i] + l));
            if (of_b) carry_over(d, pair, w[c]);
            for (int i = 0; i < 3; ++i) hn::Store(w[c][i], d, out.vertex[c][i] + l);
        }
        for (int i = 0; i < 3; ++i) {
            hn::Store(hn::Min(w[0][i], hn::Min(w[1][i], w[2][i])), d, out.low[i] + l);
            hn::Store(hn::Max(w[0][i], hn::Max(w[1][i], w[2][i])), d, out.high[i] + l);
        }
        store_planes(d, w, l, out);
    }
    for (int i = 0; i < 3; ++i) {
        VD low = hn::Load(d, out.low[i]), high = hn::Load(d, out.high[i]);
        for (std::size_t l = hn::Lanes(d); l < mesh::kMeshLeafWidth; l += hn::Lanes(d)) {
            low = hn::Min(low, hn::Load(d, out.low[i] + l));
            high = hn::Max(high, hn::Load(d, out.high[i] + l));
        }
        out.all_low[i] = hn::GetLane(hn::MinOfLanes(d, low));
        out.all_high[i] = hn::GetLane(hn::MaxOfLanes(d, high));
    }
}

// Triangles of a whose bounds meet the bound of all of b's.
HWY_INLINE std::uint32_t candidates(const LeafLanes& in_a, const LeafLanes& in_b) {
    const DD d;
    std::uint32_t lanes = 0;
    for (std::size_t l = 0; l < mesh::kMeshLeafWidth; l += hn::Lanes(d)) {
        MD near = hn::Eq(hn::Zero(d), hn::Zero(d));
        for (int i = 0; i < 3; ++i) {
            near = hn::And(near, hn::Le(hn::Load(d, in_a.low[i] + l), hn::Set(d, in_b.all_high[i])));
            near = hn::And(near, hn::Ge(hn::Load(d, in_a.high[i] + l), hn::Set(d, in_b.all_low[i])));
        }
        lanes |= bits_of(d, near, l);
    }
    return lanes;
}

// An upper bound of |w|₁ for the difference w of any two points of the leaves; the factor covers its own rounding.
HWY_INLINE double l1_extent_of(const LeafLanes& in_a, const LeafLanes& in_b) {
    double l1_extent = 0.0;
    for (int i = 0; i < 3; ++i)
        l1_extent += HWY_MAX(in_a.all_high[i], in_b.all_high[i]) - HWY_MIN(in_a.all_low[i], in_b.all_low[i]);
    return l1_extent * 1.0000001;
}

// Triangles of b whose bounds meet those of triangle `one` of a, and which are not surely on one side of its plane.
HWY_INLINE std::uint32_t partners(const LeafLanes& in_a, std::uint32_t one, const LeafLanes& in_b, double l1_extent) {
    const DD d;
    const VD error = hn::Set(d, kDeterminantError * l1_extent * in_a.normal_size[one] + kUnderflow);
    std::uint32_t lanes = 0;
    for (std::size_t l = 0; l < mesh::kMeshLeafWidth; l += hn::Lanes(d)) {
        MD near = hn::Eq(hn::Zero(d), hn::Zero(d));
        VD side[3];
        for (int i = 0; i < 3; ++i) {
            near = hn::And(near, hn::Le(hn::Load(d, in_b.low[i] + l), hn::Set(d, in_a.high[i][one])));
            near = hn::And(near, hn::Le(hn::Set(d, in_a.low[i][one]), hn::Load(d, in_b.high[i] + l)));
        }
        for (int v = 0; v < 3; ++v) {
            VD w[3];
            for (int i = 0; i < 3; ++i)
                w[i] = hn::Sub(hn::Load(d, in_b.vertex[v][i] + l), hn::Set(d, in_a.vertex[0][i][one]));
            side[v] = hn::MulAdd(
                hn::Set(d, in_a.normal[0][one]), w[0],
                hn::MulAdd(hn::Set(d, in_a.normal[1][one]), w[1], hn::Mul(hn::Set(d, in_a.normal[2][one]), w[2])));
        }
        const VD low = hn::Min(side[0], hn::Min(side[1], side[2])), high = hn::Max(side[0], hn::Max(side[1], side[2]));
        const MD apart = hn::Or(hn::Gt(low, error), hn::Lt(high, hn::Neg(error)));
        lanes |= bits_of(d, hn::AndNot(apart, near), l);
    }
    return lanes;
}

HWY_INLINE void gather(const LeafLanes& in_a, std::uint32_t lane_a, const LeafLanes& in_b, std::uint32_t lane_b,
                       TrianglePairs& pairs) {
    const std::uint32_t n = pairs.count++;
    for (int v = 0; v < 3; ++v)
        for (int i = 0; i < 3; ++i) {
            pairs.a[v][i][n] = in_a.vertex[v][i][lane_a];
            pairs.b[v][i][n] = in_b.vertex[v][i][lane_b];
        }
    pairs.of_a[n] = {in_a.leaf, lane_a};
    pairs.of_b[n] = {in_b.leaf, lane_b};
}

// How far each triangle of a reaches along `direction`, and where each of b begins.
HWY_INLINE void extents_along(const LeafLanes& in_a, const LeafLanes& in_b, const float* direction, double* end_of_a,
                              double* begin_of_b) {
    const DD d;
    for (std::size_t l = 0; l < mesh::kMeshLeafWidth; l += hn::Lanes(d)) {
        VD a[3], b[3];
        for (int v = 0; v < 3; ++v) {
            a[v] = b[v] = hn::Zero(d);
            for (int i = 0; i < 3; ++i) {
                const VD along = hn::Set(d, static_cast<double>(direction[i]));
                a[v] = hn::MulAdd(hn::Load(d, in_a.vertex[v][i] + l), along, a[v]);
                b[v] = hn::MulAdd(hn::Load(d, in_b.vertex[v][i] + l), along, b[v]);
            }
        }
        hn::Store(hn::Max(a[0], hn::Max(a[1], a[2])), d, end_of_a + l);
        hn::Store(hn::Min(b[0], hn::Min(b[1], b[2])), d, begin_of_b + l);
    }
}

// The rounding of such an extent is below 2^-50 of this, the sum of the largest coordinates.
HWY_INLINE double magnitude_of(const LeafLanes& in_a, const LeafLanes& in_b) {
    double sum = 0.0;
    for (const LeafLanes* in : {&in_a, &in_b})
        for (int i = 0; i < 3; ++i) sum += HWY_MAX(-in->all_low[i], 0.0) + HWY_MAX(in->all_high[i], 0.0);
    return sum;
}

// Bit l is set unless begin[l] lies at least sqrt(limit) beyond `end`, by more than `error_bound`. The factor covers a
// direction that is not quite of unit length.
HWY_INLINE std::uint32_t lanes_before(const double* begin, double end, double error_bound, double limit) {
    const DD d;
    std::uint32_t beyond = 0;
    for (std::size_t l = 0; l < mesh::kMeshLeafWidth; l += hn::Lanes(d)) {
        const VD from = hn::Load(d, begin + l), to = hn::Set(d, end);
        const VD gap = hn::Max(hn::Zero(d), hn::Sub(hn::Sub(from, to), hn::Set(d, error_bound)));
        beyond |= bits_of(d, hn::Gt(hn::Mul(hn::Mul(gap, gap), hn::Set(d, 0.999998)), hn::Set(d, limit)), l);
    }
    return ~beyond;
}

// Bit l is set unless the bounds of the two triangles are at least sqrt(limit) apart.
HWY_INLINE std::uint32_t near_mask(const LeafLanes& in_a, std::uint32_t one, const LeafLanes& in_b, double limit) {
    const DD d;
    std::uint32_t apart = 0;
    for (std::size_t l = 0; l < mesh::kMeshLeafWidth; l += hn::Lanes(d)) {
        VD sum = hn::Zero(d);
        for (int i = 0; i < 3; ++i) {
            VD gap = hn::Max(hn::Sub(hn::Load(d, in_b.low[i] + l), hn::Set(d, in_a.high[i][one])),
                             hn::Sub(hn::Set(d, in_a.low[i][one]), hn::Load(d, in_b.high[i] + l)));
            gap = hn::Max(hn::Zero(d), gap);
            sum = hn::MulAdd(gap, gap, sum);
        }
        apart |= bits_of(d, hn::Gt(hn::Mul(sum, hn::Set(d, 0.999999)), hn::Set(d, limit)), l);
    }
    return ~apart;
}

}  // namespace crofton::mesh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
