// One triangle of a against the eight of a leaf of b, in a's frame and in double; included once per instruction set.
#if defined(CROFTON_COLLIDE_LEAF_KERNELS) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_COLLIDE_LEAF_KERNELS
#undef CROFTON_COLLIDE_LEAF_KERNELS
#else
#define CROFTON_COLLIDE_LEAF_KERNELS
#endif

#include <hwy/highway.h>

#include "mesh_pair.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::collide::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Signs of determinants det(u, v, w) of differences of points are certain beyond kDeterminantError · |u|₁ |v|₁ |w|₁:
// Shewchuk's bound for orient3d, (7 + 56 u') u' with u' = 2^-53, holds for the sum of all products' magnitudes, which
// is at most |u|₁ |v|₁ |w|₁ in any of the factorings used here. Fused operations only lower the error. Underflow stays
// below 1e-280.
constexpr double kDeterminantError = 0x1.d0p-51;
constexpr double kUnderflow = 1e-280;

using DD = hn::CappedTag<double, tree::kMeshWidth>;
using VD = hn::Vec<DD>;
using MD = hn::Mask<DD>;

// Eight triangles with what the tests need of them, coordinates exactly those of the scalar code.
struct LeafLanes {
    alignas(64) double vertex[3][3][tree::kMeshWidth];
    alignas(64) double low[3][tree::kMeshWidth];
    alignas(64) double high[3][tree::kMeshWidth];
    alignas(64) double normal[3][tree::kMeshWidth];  // not of unit length
    alignas(64) double size[tree::kMeshWidth];       // edge sum of the bound
    alignas(64) double edges[tree::kMeshWidth];      // |u|₁ |v|₁ of the normal's factors
    double all_low[3], all_high[3];                  // of the whole leaf
    std::uint32_t leaf = ~std::uint32_t{0};          // whose lanes these are
};

HWY_INLINE VD sum_abs(const VD* v) {
    return hn::Add(hn::Abs(v[0]), hn::Add(hn::Abs(v[1]), hn::Abs(v[2])));
}

HWY_INLINE void cross(const VD* u, const VD* v, VD* out) {
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = hn::NegMulAdd(u[k], v[j], hn::Mul(u[j], v[k]));
    }
}

HWY_INLINE VD dot(const VD* u, const VD* v) {
    return hn::MulAdd(u[0], v[0], hn::MulAdd(u[1], v[1], hn::Mul(u[2], v[2])));
}

// The same roundings as transform(Pose) in pose.cpp: products and sums one by one, tiny results taken as zero.
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

HWY_INLINE void load_lanes(const MeshPair& pair, const tree::MeshLeaf& leaf, bool of_b, LeafLanes& out) {
    const DD d;
    const hn::Rebind<float, DD> df;
    for (std::size_t l = 0; l < tree::kMeshWidth; l += hn::Lanes(d)) {
        VD w[3][3], u[3], v[3], n[3];
        for (int c = 0; c < 3; ++c) {
            for (int i = 0; i < 3; ++i) w[c][i] = hn::PromoteTo(d, hn::Load(df, leaf.vertex[c][i] + l));
            if (of_b) carry_over(d, pair, w[c]);
            for (int i = 0; i < 3; ++i) hn::Store(w[c][i], d, out.vertex[c][i] + l);
        }
        VD size = hn::Zero(d);
        for (int i = 0; i < 3; ++i) {
            const VD low = hn::Min(w[0][i], hn::Min(w[1][i], w[2][i])),
                     high = hn::Max(w[0][i], hn::Max(w[1][i], w[2][i]));
            hn::Store(low, d, out.low[i] + l);
            hn::Store(high, d, out.high[i] + l);
            size = hn::Add(size, hn::Sub(high, low));
            u[i] = hn::Sub(w[1][i], w[0][i]);
            v[i] = hn::Sub(w[2][i], w[0][i]);
        }
        cross(u, v, n);
        for (int i = 0; i < 3; ++i) hn::Store(n[i], d, out.normal[i] + l);
        hn::Store(size, d, out.size + l);
        hn::Store(hn::Mul(sum_abs(u), sum_abs(v)), d, out.edges + l);
    }
    for (int i = 0; i < 3; ++i) {
        VD low = hn::Load(d, out.low[i]), high = hn::Load(d, out.high[i]);
        for (std::size_t l = hn::Lanes(d); l < tree::kMeshWidth; l += hn::Lanes(d)) {
            low = hn::Min(low, hn::Load(d, out.low[i] + l));
            high = hn::Max(high, hn::Load(d, out.high[i] + l));
        }
        out.all_low[i] = hn::GetLane(hn::MinOfLanes(d, low));
        out.all_high[i] = hn::GetLane(hn::MaxOfLanes(d, high));
    }
}

HWY_INLINE std::uint32_t bits_of(DD d, MD mask, std::size_t l) {
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, mask, bits);
    return static_cast<std::uint32_t>(bits[0]) << l;
}

// Triangles of a whose bounds meet the bound of all of b's.
HWY_INLINE std::uint32_t candidates(const LeafLanes& in_a, const LeafLanes& in_b) {
    const DD d;
    std::uint32_t lanes = 0;
    for (std::size_t l = 0; l < tree::kMeshWidth; l += hn::Lanes(d)) {
        MD near = hn::Eq(hn::Zero(d), hn::Zero(d));
        for (int i = 0; i < 3; ++i) {
            near = hn::And(near, hn::Le(hn::Load(d, in_a.low[i] + l), hn::Set(d, in_b.all_high[i])));
            near = hn::And(near, hn::Ge(hn::Load(d, in_a.high[i] + l), hn::Set(d, in_b.all_low[i])));
        }
        lanes |= bits_of(d, near, l);
    }
    return lanes;
}

struct Sides {
    MD above[3], below[3];  // certain
};

// Sides of the three points `p` of the plane through `origin` with `normal`.
HWY_INLINE Sides sides_of(const VD* normal, const VD* origin, const VD (&p)[3][3], VD error) {
    Sides sides;
    for (int k = 0; k < 3; ++k) {
        VD w[3];
        for (int i = 0; i < 3; ++i) w[i] = hn::Sub(p[k][i], origin[i]);
        const VD value = dot(normal, w);
        sides.above[k] = hn::Gt(value, error);
        sides.below[k] = hn::Lt(value, hn::Neg(error));
    }
    return sides;
}

HWY_INLINE MD all_on_one_side(const Sides& s) {
    return hn::Or(hn::And(s.above[0], hn::And(s.above[1], s.above[2])),
                  hn::And(s.below[0], hn::And(s.below[1], s.below[2])));
}

// An edge from corner k to the next, with the signs of its three determinants against the other triangle's edges: it
// pierces when the ends lie apart and the signs agree; it misses when the ends lie together or the signs differ.
HWY_INLINE void judge_edge(const Sides& s, int k, const MD* positive, const MD* negative, MD& hit, MD& miss) {
    const int n = (k + 1) % 3;
    const MD apart = hn::Or(hn::And(s.above[k], s.below[n]), hn::And(s.below[k], s.above[n]));
    const MD together = hn::Or(hn::And(s.above[k], s.above[n]), hn::And(s.below[k], s.below[n]));
    const MD agree = hn::Or(hn::And(positive[0], hn::And(positive[1], positive[2])),
                            hn::And(negative[0], hn::And(negative[1], negative[2])));
    const MD differ = hn::And(hn::Or(positive[0], hn::Or(positive[1], positive[2])),
                              hn::Or(negative[0], hn::Or(negative[1], negative[2])));
    hit = hn::Or(hit, hn::And(apart, agree));
    miss = hn::And(miss, hn::Or(together, differ));
}

// Two triangles meet, unless an end or a plane is touched, iff an edge of one pierces the other. The nine determinants
// of an edge of each serve both directions.
HWY_INLINE void judge_edges(DD d, const VD (&a)[3][3], const VD (&b)[3][3], const Sides& of_a, const Sides& of_b,
                            VD reach, MD& hit, MD& miss) {
    VD v[3][3], size[3];
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) v[j][i] = hn::Sub(b[(j + 1) % 3][i], b[j][i]);
        size[j] = hn::Mul(hn::Mul(sum_abs(v[j]), reach), hn::Set(d, kDeterminantError));
    }
    MD positive[3][3], negative[3][3];  // [edge of a][edge of b]
    for (int e = 0; e < 3; ++e) {
        VD u[3];
        for (int i = 0; i < 3; ++i) u[i] = hn::Sub(a[(e + 1) % 3][i], a[e][i]);
        const VD length = sum_abs(u);
        for (int j = 0; j < 3; ++j) {
            VD n[3], w[3];
            cross(u, v[j], n);
            for (int i = 0; i < 3; ++i) w[i] = hn::Sub(b[j][i], a[e][i]);
            const VD value = dot(n, w), error = hn::MulAdd(size[j], length, hn::Set(d, kUnderflow));
            positive[e][j] = hn::Gt(value, error);
            negative[e][j] = hn::Lt(value, hn::Neg(error));
        }
    }
    for (int k = 0; k < 3; ++k) {
        judge_edge(of_a, k, positive[k], negative[k], hit, miss);
        const MD up[3] = {positive[0][k], positive[1][k], positive[2][k]};
        const MD down[3] = {negative[0][k], negative[1][k], negative[2][k]};
        judge_edge(of_b, k, up, down, hit, miss);
    }
}

// Triangle `one` of a against all of b: lanes that surely meet it, and lanes that need exact arithmetic.
HWY_INLINE LaneVerdict judge(const LeafLanes& in_a, std::uint32_t one, const LeafLanes& in_b) {
    const DD d;
    LaneVerdict verdict;
    for (std::size_t l = 0; l < tree::kMeshWidth; l += hn::Lanes(d)) {
        MD near = hn::Eq(hn::Zero(d), hn::Zero(d));
        for (int i = 0; i < 3; ++i) {
            near = hn::And(near, hn::Le(hn::Load(d, in_b.low[i] + l), hn::Set(d, in_a.high[i][one])));
            near = hn::And(near, hn::Le(hn::Set(d, in_a.low[i][one]), hn::Load(d, in_b.high[i] + l)));
        }
        if (hn::AllFalse(d, near)) continue;
        VD a[3][3], b[3][3], na[3], nb[3];
        for (int i = 0; i < 3; ++i) {
            for (int c = 0; c < 3; ++c) {
                a[c][i] = hn::Set(d, in_a.vertex[c][i][one]);
                b[c][i] = hn::Load(d, in_b.vertex[c][i] + l);
            }
            na[i] = hn::Set(d, in_a.normal[i][one]);
            nb[i] = hn::Load(d, in_b.normal[i] + l);
        }
        // Bounds meet, so no two points are farther apart than both together; rounding of the sizes is far below the
        // margin.
        const VD reach =
            hn::Mul(hn::Add(hn::Load(d, in_b.size + l), hn::Set(d, in_a.size[one])), hn::Set(d, 1.0000001));
        const VD scale = hn::Mul(reach, hn::Set(d, kDeterminantError)), tiny = hn::Set(d, kUnderflow);
        const Sides of_b = sides_of(na, a[0], b, hn::MulAdd(scale, hn::Set(d, in_a.edges[one]), tiny));
        near = hn::AndNot(all_on_one_side(of_b), near);
        if (hn::AllFalse(d, near)) continue;
        const Sides of_a = sides_of(nb, b[0], a, hn::MulAdd(scale, hn::Load(d, in_b.edges + l), tiny));
        near = hn::AndNot(all_on_one_side(of_a), near);
        if (hn::AllFalse(d, near)) continue;
        MD hit = hn::Lt(hn::Zero(d), hn::Zero(d)), miss = hn::Eq(hn::Zero(d), hn::Zero(d));
        judge_edges(d, a, b, of_a, of_b, reach, hit, miss);
        verdict.hits |= bits_of(d, hn::And(near, hit), l);
        verdict.open |= bits_of(d, hn::AndNot(hn::Or(hit, miss), near), l);
    }
    return verdict;
}

// Bit l is set unless the bounds of the two triangles are at least sqrt(limit) apart.
HWY_INLINE std::uint32_t near_mask(const LeafLanes& in_a, std::uint32_t one, const LeafLanes& in_b, double limit) {
    const DD d;
    std::uint32_t apart = 0;
    for (std::size_t l = 0; l < tree::kMeshWidth; l += hn::Lanes(d)) {
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

}  // namespace crofton::collide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
