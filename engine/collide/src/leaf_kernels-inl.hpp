// One triangle of a against the eight of a leaf of b, in a's frame; included once per instruction set.
#if defined(CROFTON_COLLIDE_LEAF_KERNELS) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_COLLIDE_LEAF_KERNELS
#undef CROFTON_COLLIDE_LEAF_KERNELS
#else
#define CROFTON_COLLIDE_LEAF_KERNELS
#endif

#include <hwy/highway.h>

#include "mesh_kernels-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::collide::HWY_NAMESPACE {

// b's triangles in a's frame, each coordinate within `slop` of the exact one.
struct LeafLanes {
    alignas(64) float vertex[3][3][tree::kMeshWidth];
    alignas(64) float low[3][tree::kMeshWidth];
    alignas(64) float high[3][tree::kMeshWidth];
    alignas(64) float normal[3][tree::kMeshWidth];
    alignas(64) float size[tree::kMeshWidth];          // edge sum of the bound
    alignas(64) float normal_error[tree::kMeshWidth];  // of dot(normal, x − vertex 0) per unit of |x − vertex 0|
    alignas(64) float offset_error[tree::kMeshWidth];  // and what does not grow with it
};

HWY_INLINE V sum_of_magnitudes(const V* v) {
    return hn::Add(hn::Abs(v[0]), hn::Add(hn::Abs(v[1]), hn::Abs(v[2])));
}

// An edge u of b is off by 2 slop and its own rounding, hence the normal u × v by at most 4 slop (|u| + |v|) + 8 slop²
// and 1e-6 |u||v| (sums of magnitudes throughout, so constants are generous).
HWY_INLINE void load_lanes(const MeshPair& pair, const tree::MeshLeaf& leaf, LeafLanes& out) {
    const D d;
    for (std::size_t l = 0; l < tree::kMeshWidth; l += hn::Lanes(d)) {
        V w[3][3];
        for (int v = 0; v < 3; ++v) {
            const V x = hn::Load(d, leaf.vertex[v][0] + l), y = hn::Load(d, leaf.vertex[v][1] + l),
                    z = hn::Load(d, leaf.vertex[v][2] + l);
            for (int i = 0; i < 3; ++i) {
                w[v][i] = hn::MulAdd(
                    hn::Set(d, pair.rotation[i][0]), x,
                    hn::MulAdd(hn::Set(d, pair.rotation[i][1]), y,
                               hn::MulAdd(hn::Set(d, pair.rotation[i][2]), z, hn::Set(d, pair.translation[i]))));
                hn::Store(w[v][i], d, out.vertex[v][i] + l);
            }
        }
        V size = hn::Zero(d), u[3], v[3], n[3];
        for (int i = 0; i < 3; ++i) {
            const V low = hn::Min(w[0][i], hn::Min(w[1][i], w[2][i])),
                    high = hn::Max(w[0][i], hn::Max(w[1][i], w[2][i]));
            hn::Store(low, d, out.low[i] + l);
            hn::Store(high, d, out.high[i] + l);
            size = hn::Add(size, hn::Sub(high, low));
            u[i] = hn::Sub(w[1][i], w[0][i]);
            v[i] = hn::Sub(w[2][i], w[0][i]);
        }
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            n[i] = hn::NegMulAdd(u[k], v[j], hn::Mul(u[j], v[k]));
            hn::Store(n[i], d, out.normal[i] + l);
        }
        hn::Store(size, d, out.size + l);
        const V su = sum_of_magnitudes(u), sv = sum_of_magnitudes(v), slop = hn::Set(d, pair.slop);
        const V edges = hn::Mul(hn::Set(d, 4.0f * pair.slop), hn::Add(hn::Add(su, sv), hn::Add(slop, slop)));
        hn::Store(hn::MulAdd(hn::Mul(su, sv), hn::Set(d, 2e-6f), edges), d, out.normal_error + l);
        hn::Store(hn::MulAdd(sum_of_magnitudes(n), hn::Set(d, 2.0f * pair.slop), hn::Set(d, 1e-30f)), d,
                  out.offset_error + l);
    }
}

struct OneTriangle {
    float vertex[3][3];
    float low[3], high[3], normal[3];
    float size, normal_error, offset_error;
};

HWY_INLINE OneTriangle load_one(const MeshPair& pair, const tree::MeshLeaf& leaf, std::uint32_t lane) {
    OneTriangle t;
    float u[3], v[3], su = 0.0f, sv = 0.0f, sn = 0.0f;
    t.size = 0.0f;
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) t.vertex[k][i] = leaf.vertex[k][i][lane];
        t.low[i] = HWY_MIN(t.vertex[0][i], HWY_MIN(t.vertex[1][i], t.vertex[2][i]));
        t.high[i] = HWY_MAX(t.vertex[0][i], HWY_MAX(t.vertex[1][i], t.vertex[2][i]));
        t.size += t.high[i] - t.low[i];
        u[i] = t.vertex[1][i] - t.vertex[0][i];
        v[i] = t.vertex[2][i] - t.vertex[0][i];
        su += u[i] < 0.0f ? -u[i] : u[i];
        sv += v[i] < 0.0f ? -v[i] : v[i];
    }
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        t.normal[i] = u[j] * v[k] - u[k] * v[j];
        sn += t.normal[i] < 0.0f ? -t.normal[i] : t.normal[i];
    }
    t.normal_error = 2e-6f * su * sv;
    t.offset_error = 2.0f * pair.slop * sn + 1e-30f;
    return t;
}

HWY_INLINE V dot_from(const V* n, const V* point, const V* origin) {
    return hn::MulAdd(n[0], hn::Sub(point[0], origin[0]),
                      hn::MulAdd(n[1], hn::Sub(point[1], origin[1]), hn::Mul(n[2], hn::Sub(point[2], origin[2]))));
}

// Bit l is set unless triangle l of b surely does not meet t: bounds apart, or one triangle strictly on one side of the
// other's plane. Distances that matter are at most the sum of both bounds' edges, or the bounds are apart.
HWY_INLINE std::uint32_t triangle_mask(const MeshPair& pair, const OneTriangle& t, const LeafLanes& b) {
    const D d;
    std::uint32_t apart = 0;
    for (std::size_t l = 0; l < tree::kMeshWidth; l += hn::Lanes(d)) {
        const V slop = hn::Set(d, pair.slop), zero = hn::Zero(d);
        V gap = hn::Neg(slop);
        V a[3][3], w[3][3], na[3], nb[3];
        for (int i = 0; i < 3; ++i) {
            gap = hn::Max(gap, hn::Sub(hn::Load(d, b.low[i] + l), hn::Set(d, t.high[i])));
            gap = hn::Max(gap, hn::Sub(hn::Set(d, t.low[i]), hn::Load(d, b.high[i] + l)));
        }
        auto separate = hn::Gt(gap, slop);
        if (!hn::AllTrue(d, separate)) {
            for (int i = 0; i < 3; ++i) {
                for (int v = 0; v < 3; ++v) {
                    a[v][i] = hn::Set(d, t.vertex[v][i]);
                    w[v][i] = hn::Load(d, b.vertex[v][i] + l);
                }
                na[i] = hn::Set(d, t.normal[i]);
                nb[i] = hn::Load(d, b.normal[i] + l);
            }
            const V reach = hn::Add(hn::Add(hn::Load(d, b.size + l), hn::Set(d, t.size)), hn::Add(slop, slop));
            const V a0 = dot_from(na, w[0], a[0]), a1 = dot_from(na, w[1], a[0]), a2 = dot_from(na, w[2], a[0]);
            const V error_a = hn::MulAdd(reach, hn::Set(d, t.normal_error), hn::Set(d, t.offset_error));
            const V b0 = dot_from(nb, a[0], w[0]), b1 = dot_from(nb, a[1], w[0]), b2 = dot_from(nb, a[2], w[0]);
            const V error_b = hn::MulAdd(reach, hn::Load(d, b.normal_error + l), hn::Load(d, b.offset_error + l));
            const V side_a = hn::Max(hn::Min(a0, hn::Min(a1, a2)), hn::Neg(hn::Max(a0, hn::Max(a1, a2))));
            const V side_b = hn::Max(hn::Min(b0, hn::Min(b1, b2)), hn::Neg(hn::Max(b0, hn::Max(b1, b2))));
            const V margin = hn::Max(hn::Sub(side_a, error_a), hn::Sub(side_b, error_b));
            separate = hn::Or(separate, hn::Gt(margin, zero));
        }
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(d, separate, bits);
        apart |= static_cast<std::uint32_t>(bits[0]) << l;
    }
    return ~apart;
}

// Bit l is set unless the bounds of t and of triangle l of b are surely at least sqrt(limit) apart.
HWY_INLINE std::uint32_t near_mask(const MeshPair& pair, const OneTriangle& t, const LeafLanes& b, float limit) {
    const D d;
    std::uint32_t apart = 0;
    for (std::size_t l = 0; l < tree::kMeshWidth; l += hn::Lanes(d)) {
        V sum = hn::Zero(d);
        for (int i = 0; i < 3; ++i) {
            V gap = hn::Max(hn::Sub(hn::Load(d, b.low[i] + l), hn::Set(d, t.high[i])),
                            hn::Sub(hn::Set(d, t.low[i]), hn::Load(d, b.high[i] + l)));
            gap = hn::Max(hn::Zero(d), hn::Sub(gap, hn::Set(d, pair.slop)));
            sum = hn::MulAdd(gap, gap, sum);
        }
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(d, hn::Gt(hn::Mul(sum, hn::Set(d, 0.99999f)), hn::Set(d, limit)), bits);
        apart |= static_cast<std::uint32_t>(bits[0]) << l;
    }
    return ~apart;
}

}  // namespace crofton::collide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
