// SPDX-License-Identifier: MIT
// A ray against the triangles of a leaf. Included once per instruction set.
#if defined(CROFTON_MESH_RAY_LEAF) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_MESH_RAY_LEAF
#undef CROFTON_MESH_RAY_LEAF
#else
#define CROFTON_MESH_RAY_LEAF
#endif

#include <hwy/highway.h>

#include "double_lanes-inl.hpp"
#include "ray_mesh.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::mesh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Not below t, in the kernel's parameters.
HWY_INLINE float limit_of(const RayQuery& q, double t) {
    const double reached = t * q.scale;
    return reached < 1e37 ? static_cast<float>(reached) * (1.0f + 0x1p-20f) : 1e37f;
}

// Triangles that the ray may meet before `limit`, in float. In the plane coordinates the ray is the origin, and it
// passes outside of a triangle if two of the edges have it on different sides (Woop, Benthin, Wald 2013). Positions are
// taken from the ray's point at `along`, beside the leaf. Let u be 2^-24 of the start's and the mesh's largest
// coordinates together. That point is off the ray by 3 u in each coordinate: by the roundings of the start, of the way
// to it and of their sum. This counts twice, as 6 u, as the shear is at most 1. A difference from it is rounded by 2 u,
// again twice. The shear has four roundings, of differences up to 2 of these coordinates: 8 u. The last product and sum
// add 4 u. These 22 u are within 2 e, with e the query's error bound, at least 12.5 u. With m the largest plane
// coordinate, an edge's value is off by at most 8 m e + 8 e²
// + 2^-21 m². No triangle is hit before its nearest vertex along the ray, whose parameter is off by less than e: 1 /
// direction_f[z] is at most 1.
HWY_INLINE std::uint32_t candidates(const mesh::MeshLeaf& leaf, const RayQuery& q, float along, float limit) {
    const hn::CappedTag<float, mesh::kMeshLeafWidth> d;
    using VF = hn::Vec<decltype(d)>;
    const std::uint32_t x = q.axis[0], y = q.axis[1], z = q.axis[2];
    float beside[3];
    for (int i = 0; i < 3; ++i) beside[i] = q.start[i] + along * q.direction_f[i];
    std::uint32_t lanes = 0;
    for (std::size_t l = 0; l < mesh::kMeshLeafWidth; l += hn::Lanes(d)) {
        VF px[3], py[3], nearest = hn::Set(d, 3e38f), m = hn::Zero(d);
        for (int v = 0; v < 3; ++v) {
            const VF pz = hn::Sub(hn::Load(d, leaf.vertex[v][z] + l), hn::Set(d, beside[z]));
            px[v] = hn::NegMulAdd(hn::Set(d, q.shear[0]), pz,
                                  hn::Sub(hn::Load(d, leaf.vertex[v][x] + l), hn::Set(d, beside[x])));
            py[v] = hn::NegMulAdd(hn::Set(d, q.shear[1]), pz,
                                  hn::Sub(hn::Load(d, leaf.vertex[v][y] + l), hn::Set(d, beside[y])));
            nearest = hn::Min(nearest, hn::Mul(pz, hn::Set(d, q.inverse[z])));
            m = hn::Max(m, hn::Max(hn::Abs(px[v]), hn::Abs(py[v])));
        }
        const VF error_bound = hn::Set(d, 8.0f * q.error_bound);
        const VF error = hn::MulAdd(hn::MulAdd(m, hn::Set(d, 0x1p-21f), error_bound), m,
                                    hn::Mul(error_bound, hn::Set(d, q.error_bound)));
        VF low = hn::Set(d, 3e38f), high = hn::Set(d, -3e38f);
        for (int v = 0; v < 3; ++v) {
            const int w = (v + 1) % 3;
            const VF side = hn::NegMulAdd(py[v], px[w], hn::Mul(px[v], py[w]));
            low = hn::Min(low, side);
            high = hn::Max(high, side);
        }
        const auto apart = hn::And(hn::Lt(low, hn::Neg(error)), hn::Gt(high, error));
        const auto beyond = hn::Gt(nearest, hn::Set(d, limit - along + q.error_bound));
        lanes |= simd::mask_bits(d, hn::Or(apart, beyond)) << l;
    }
    return ~lanes & ((1u << mesh::kMeshLeafWidth) - 1u);  // unused lanes repeat the last triangle
}

// Where the line meets the planes of the triangles, kept between the nearest and the farthest vertex along it. A
// triangle that is hit is hit there, also where the line lies so close to its plane that rounding leaves nothing of the
// quotient.
HWY_INLINE VD parameters(DD d, const VD (&p)[3][3], const VD* direction) {
    VD u[3], v[3], n[3];
    for (int i = 0; i < 3; ++i) {
        u[i] = hn::Sub(p[1][i], p[0][i]);
        v[i] = hn::Sub(p[2][i], p[0][i]);
    }
    rounded_cross(u, v, n);
    const VD by_plane = hn::Div(rounded_dot(n, p[0]), rounded_dot(n, direction));
    const VD per_length = hn::Div(hn::Set(d, 1.0), rounded_dot(direction, direction));
    const VD at[3] = {hn::Mul(rounded_dot(p[0], direction), per_length),
                      hn::Mul(rounded_dot(p[1], direction), per_length),
                      hn::Mul(rounded_dot(p[2], direction), per_length)};
    const VD low = hn::Min(at[0], hn::Min(at[1], at[2])), high = hn::Max(at[0], hn::Max(at[1], at[2]));
    const VD margin = hn::Mul(hn::Max(hn::Abs(low), hn::Abs(high)), hn::Set(d, 1e-12));
    const VD least = hn::Sub(low, margin), most = hn::Add(high, margin);
    return hn::IfThenElse(hn::Lt(by_plane, least), least, hn::IfThenElse(hn::Le(by_plane, most), by_plane, most));
}

// Of one vector of triangles: which the ray meets for certain, and which it may meet.
struct Verdicts {
    MD met, open;
};

// p: the vertices seen from the ray's start. The line passes through a triangle iff its three determinants with the
// edges do not differ in sign. Let s be their sum, and v = det(p[0], p[1], p[2]): it comes to the triangle's plane at
// the parameter v / s. So it does before its start where v and s differ in sign, and beyond its end where v − max_t · s
// and s agree.
HWY_INLINE Verdicts verdicts(DD d, const VD (&p)[3][3], const VD* direction, double max_t) {
    const VD zero = hn::Zero(d), smallest = hn::Set(d, 1e-280), error_bound = hn::Set(d, kDeterminantError);
    const VD length = sum_abs(direction);
    const VD size[3] = {sum_abs(p[0]), sum_abs(p[1]), sum_abs(p[2])};
    MD positive = hn::Lt(zero, zero), negative = positive, unknown = positive;
    VD n[3], sum = zero, sizes = zero;
    for (int v = 0; v < 3; ++v) {
        const int w = (v + 1) % 3;
        cross(p[v], p[w], n);
        const VD value = dot(direction, n), product = hn::Mul(size[v], size[w]);
        const VD error = hn::MulAdd(hn::Mul(product, length), error_bound, smallest);
        const MD up = hn::Gt(value, error), down = hn::Lt(value, hn::Neg(error));
        positive = hn::Or(positive, up);
        negative = hn::Or(negative, down);
        unknown = hn::Or(unknown, hn::Not(hn::Or(up, down)));
        sum = hn::Add(sum, value);
        sizes = hn::Add(sizes, product);
    }
    const VD volume = dot(p[1], n);  // n = cross(p[2], p[0])
    const VD volume_size = hn::Mul(hn::Mul(size[0], size[1]), size[2]);
    const VD error = hn::MulAdd(volume_size, error_bound, smallest);
    const MD above = hn::Gt(volume, error), below = hn::Lt(volume, hn::Neg(error));
    MD out = hn::Or(hn::And(positive, negative), hn::Or(hn::And(positive, below), hn::And(negative, above)));
    unknown = hn::Or(unknown, hn::Not(hn::Or(above, below)));
    if (max_t < 1e300) {
        // Three sums and a product more: twice the bound. What overflows is unknown.
        const VD end = hn::Set(d, max_t);
        const VD past = hn::NegMulAdd(end, sum, volume);
        const VD wide = hn::MulAdd(hn::Mul(end, length), sizes, volume_size);
        const VD doubt = hn::MulAdd(wide, hn::Add(error_bound, error_bound), smallest);
        const MD beyond = hn::Gt(past, doubt), within = hn::Lt(past, hn::Neg(doubt));
        out = hn::Or(out, hn::Or(hn::And(positive, beyond), hn::And(negative, within)));
        unknown = hn::Or(unknown, hn::Not(hn::Or(beyond, within)));
    }
    return {hn::AndNot(hn::Or(out, unknown), hn::Eq(zero, zero)), hn::AndNot(out, unknown)};
}

// `open`: lanes where a sign is uncertain. Of the lanes, only those that are wanted, and their neighbours in a vector,
// are looked at. A parameter is kept on the ray.
HWY_INLINE std::uint32_t triangle_hits(const mesh::MeshLeaf& leaf, const RayQuery& q, std::uint32_t wanted, double* t,
                                       std::uint32_t& open) {
    const DD d;
    const hn::Rebind<float, DD> df;
    std::uint32_t hits = 0;
    for (std::size_t l = 0; l < mesh::kMeshLeafWidth; l += hn::Lanes(d)) {
        if ((wanted >> l & ((1u << hn::Lanes(d)) - 1u)) == 0) continue;
        VD p[3][3], direction[3];
        for (int i = 0; i < 3; ++i) {
            direction[i] = hn::Set(d, q.direction[i]);
            for (int v = 0; v < 3; ++v)
                p[v][i] = hn::Sub(hn::PromoteTo(d, hn::Load(df, leaf.vertex[v][i] + l)), hn::Set(d, q.origin[i]));
        }
        // NaN, where coordinates overflow, stays so, and is no hit.
        const VD at = parameters(d, p, direction), zero = hn::Zero(d), end = hn::Set(d, q.max_t);
        const VD from_start = hn::IfThenElse(hn::Lt(at, zero), zero, at);
        hn::Store(hn::IfThenElse(hn::Gt(from_start, end), end, from_start), d, t + l);
        const Verdicts found = verdicts(d, p, direction, q.max_t);
        hits |= bits_of(d, found.met, l);
        open |= bits_of(d, found.open, l);
    }
    return hits;
}

// True if it has changed the answer. `along`: where the ray comes to the leaf's box.
HWY_INLINE bool trace_leaf(const RayQuery& q, std::uint32_t index, float along, float limit, ExactTest meets,
                           RayAnswer& answer) {
    const mesh::MeshLeaf& leaf = q.leaves[index];
    const std::uint32_t wanted = candidates(leaf, q, along, limit);
    if (wanted == 0) return false;
    HWY_ALIGN double t[mesh::kMeshLeafWidth];
    std::uint32_t open = 0;
    bool found = false;
    std::uint32_t lanes = triangle_hits(leaf, q, wanted, t, open);
    lanes = (lanes | open) & wanted;
    for (; lanes != 0; lanes &= lanes - 1) {
        const auto lane = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes));
        if (!(t[lane] <= answer.t)) continue;
        if (answer.hit && t[lane] == answer.t && leaf.triangle[lane] > answer.triangle) continue;
        if ((open >> lane & 1u) && !meets(index, lane)) continue;
        answer = {t[lane], leaf.triangle[lane], true};
        found = true;
        if (q.any) return true;
    }
    return found;
}

}  // namespace crofton::mesh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
