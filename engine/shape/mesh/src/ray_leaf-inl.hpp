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

// Rays and triangles, a pair in each lane: the vertices' differences from a point of the ray, along the axes of the
// plane coordinates; and what RayQuery has of the ray.
template <class V>
struct FloatLanes {
    V x[3], y[3], z[3], shear[2], inverse;
    V reach;          // from that point to the limit, and the error bound
    V start, finish;  // where certain hits begin and end, seen from there; read only where these are asked for
};

// Pairs that certainly do not meet before the limit. In the plane coordinates the ray is the origin, and it passes
// outside of a triangle if two of the edges have it on different sides (Woop, Benthin, Wald 2013). Positions are
// taken from the ray's point at `along`, beside the triangle. Let u be 2^-24 of the start's and the mesh's largest
// coordinates together. That point is off the ray by 3 u in each coordinate: by the roundings of the start, of the way
// to it and of their sum. This counts twice, as 6 u, as the shear is at most 1. A difference from it is rounded by 2 u,
// again twice. The shear has four roundings, of differences up to 2 of these coordinates: 8 u. The last product and sum
// add 4 u. These 22 u are within 2 e, with e the query's error bound, at least 12.5 u. With m the largest plane
// coordinate, an edge's value is off by at most 8 m e + 8 e²
// + 2^-21 m², and what underflows is below 1e-37. No triangle is hit before its nearest vertex along the ray, whose
// parameter is off by less than e: 1 / direction[z] is at most 1.
//
// By the same bounds a ray certainly passes through a triangle whose edges have it on one side, and hits it between the
// nearest vertex and the farthest: `met`, where that is not null.
template <class D, class V = hn::Vec<D>>
HWY_INLINE hn::Mask<D> certainly_apart(D d, const FloatLanes<V>& lanes, float error_bound, hn::Mask<D>* met = nullptr) {
    V px[3], py[3], nearest = hn::Set(d, 3e38f), m = hn::Zero(d);
    for (int v = 0; v < 3; ++v) {
        px[v] = hn::NegMulAdd(lanes.shear[0], lanes.z[v], lanes.x[v]);
        py[v] = hn::NegMulAdd(lanes.shear[1], lanes.z[v], lanes.y[v]);
        nearest = hn::Min(nearest, hn::Mul(lanes.z[v], lanes.inverse));
        m = hn::Max(m, hn::Max(hn::Abs(px[v]), hn::Abs(py[v])));
    }
    const V eight = hn::Set(d, 8.0f * error_bound);
    const V least = hn::MulAdd(eight, hn::Set(d, error_bound), hn::Set(d, 1e-37f));
    const V error = hn::MulAdd(hn::MulAdd(m, hn::Set(d, 0x1p-21f), eight), m, least);
    V low = hn::Set(d, 3e38f), high = hn::Set(d, -3e38f);
    for (int v = 0; v < 3; ++v) {
        const int w = (v + 1) % 3;
        const V side = hn::NegMulAdd(py[v], px[w], hn::Mul(px[v], py[w]));
        low = hn::Min(low, side);
        high = hn::Max(high, side);
    }
    if (met != nullptr) {
        V farthest = hn::Mul(lanes.z[0], lanes.inverse);
        for (int v = 1; v < 3; ++v) farthest = hn::Max(farthest, hn::Mul(lanes.z[v], lanes.inverse));
        const auto through = hn::Or(hn::Gt(low, error), hn::Lt(high, hn::Neg(error)));
        const auto within = hn::And(hn::Gt(nearest, lanes.start), hn::Lt(farthest, lanes.finish));
        *met = hn::And(through, within);
    }
    const auto outside = hn::And(hn::Lt(low, hn::Neg(error)), hn::Gt(high, error));
    return hn::Or(outside, hn::Gt(nearest, lanes.reach));
}

// Triangles that the ray may meet before `limit`, in float. `along`: where it is beside them. Where any hit will do,
// `met` says whether one of them is certainly hit.
HWY_INLINE std::uint32_t candidates(const mesh::MeshLeaf& leaf, const RayQuery& q, float along, float limit,
                                    bool& met) {
    const hn::CappedTag<float, mesh::kMeshLeafWidth> d;
    float beside[3];
    for (int i = 0; i < 3; ++i) beside[i] = q.start[i] + along * q.direction[i];
    std::uint32_t apart = 0;
    for (std::size_t l = 0; l < mesh::kMeshLeafWidth; l += hn::Lanes(d)) {
        FloatLanes<hn::Vec<decltype(d)>> lanes;
        for (int v = 0; v < 3; ++v) {
            const auto difference = [&](std::uint32_t i) HWY_ATTR {
                return hn::Sub(hn::Load(d, leaf.vertex[v][i] + l), hn::Set(d, beside[i]));
            };
            lanes.x[v] = difference(q.axis[0]);
            lanes.y[v] = difference(q.axis[1]);
            lanes.z[v] = difference(q.axis[2]);
        }
        for (int k = 0; k < 2; ++k) lanes.shear[k] = hn::Set(d, q.shear[k]);
        lanes.inverse = hn::Set(d, q.inverse[q.axis[2]]);
        lanes.reach = hn::Set(d, limit - along + q.error_bound);
        if (!q.any) {
            apart |= simd::mask_bits(d, certainly_apart(d, lanes, q.error_bound)) << l;
            continue;
        }
        lanes.start = hn::Set(d, 2.0f * q.error_bound - along);
        lanes.finish = hn::Set(d, limit * (1.0f - 0x1p-18f) - along - 2.0f * q.error_bound);  // limit_of() rounds up
        hn::Mask<decltype(d)> certain;
        apart |= simd::mask_bits(d, certainly_apart(d, lanes, q.error_bound, &certain)) << l;
        met |= !hn::AllFalse(d, certain);
    }
    return ~apart & ((1u << mesh::kMeshLeafWidth) - 1u);  // unused lanes repeat the last triangle
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

// Lanes of rays and triangles, a pair in each. p: the vertices seen from the ray's start; max_t: its end.
struct RayLanes {
    VD p[3][3], direction[3], max_t;
    bool ends;  // some of the rays may end before 1e300
};

// The line passes through a triangle iff its three determinants with the edges do not differ in sign. Let s be their
// sum, and v = det(p[0], p[1], p[2]): it comes to the triangle's plane at the parameter v / s. So it does before its
// start where v and s differ in sign, and beyond its end where v − max_t · s and s agree.
HWY_INLINE Verdicts verdicts(DD d, const RayLanes& lanes) {
    const VD(&p)[3][3] = lanes.p;
    const VD* const direction = lanes.direction;
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
    if (lanes.ends) {
        // Three sums and a product more: twice the bound. What overflows is unknown.
        const VD end = lanes.max_t;
        const MD has_end = hn::Lt(end, hn::Set(d, 1e300));
        const VD past = hn::NegMulAdd(end, sum, volume);
        const VD wide = hn::MulAdd(hn::Mul(end, length), sizes, volume_size);
        const VD doubt = hn::MulAdd(wide, hn::Add(error_bound, error_bound), smallest);
        const MD beyond = hn::Gt(past, doubt), within = hn::Lt(past, hn::Neg(doubt));
        const MD late = hn::Or(hn::And(positive, beyond), hn::And(negative, within));
        out = hn::Or(out, hn::And(has_end, late));
        unknown = hn::Or(unknown, hn::AndNot(hn::Or(beyond, within), has_end));
    }
    return {hn::AndNot(hn::Or(out, unknown), hn::Eq(zero, zero)), hn::AndNot(out, unknown)};
}

// Bits of lanes: those that are hit for certain, and those where a sign is uncertain.
struct HitBits {
    std::uint32_t met = 0, open = 0;
};

// Writes the parameters, kept on the ray, of all lanes. NaN, where coordinates overflow, stays so, and is no hit.
HWY_INLINE HitBits hits_of(DD d, const RayLanes& lanes, std::size_t l, double* t) {
    const VD at = parameters(d, lanes.p, lanes.direction), zero = hn::Zero(d);
    const VD from_start = hn::IfThenElse(hn::Lt(at, zero), zero, at);
    hn::Store(hn::IfThenElse(hn::Gt(from_start, lanes.max_t), lanes.max_t, from_start), d, t);
    const Verdicts found = verdicts(d, lanes);
    return {bits_of(d, found.met, l), bits_of(d, found.open, l)};
}

// Of the leaf's triangles only those that are wanted, and their neighbours in a vector, are looked at.
HWY_INLINE HitBits triangle_hits(const mesh::MeshLeaf& leaf, const RayQuery& q, std::uint32_t wanted, double* t) {
    const DD d;
    const hn::Rebind<float, DD> df;
    HitBits hits;
    // Mostly one triangle is wanted, so one vector: which one is no branch.
    for (std::uint32_t rest = wanted; rest != 0;) {
        const std::size_t l = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest) / hn::Lanes(d) * hn::Lanes(d);
        rest &= ~(((1u << hn::Lanes(d)) - 1u) << l);
        RayLanes lanes;
        for (int i = 0; i < 3; ++i) {
            lanes.direction[i] = hn::Set(d, q.ray[3 + i]);
            for (int v = 0; v < 3; ++v)
                lanes.p[v][i] = hn::Sub(hn::PromoteTo(d, hn::Load(df, leaf.vertex[v][i] + l)), hn::Set(d, q.ray[i]));
        }
        lanes.max_t = hn::Set(d, q.ray[6]);
        lanes.ends = q.ray[6] < 1e300;
        const HitBits found = hits_of(d, lanes, l, t + l);
        hits.met |= found.met;
        hits.open |= found.open;
    }
    return hits;
}

// Whether a hit comes before the answer; of equal ones the triangle of lowest index counts.
HWY_INLINE bool is_before(double t, std::uint32_t triangle, const RayAnswer& answer) {
    return t <= answer.t && !(answer.hit && t == answer.t && triangle > answer.triangle);
}

// True if it has changed the answer; where any hit will do, `hit` alone. `along`: where the ray comes to the leaf's
// box.
HWY_INLINE bool trace_leaf(const RayQuery& q, std::uint32_t index, float along, float limit, ExactTest meets,
                           RayAnswer& answer) {
    const mesh::MeshLeaf& leaf = q.mesh.leaves[index];
    bool met = false;
    const std::uint32_t wanted = candidates(leaf, q, along, limit, met);
    if (wanted == 0) return false;
    if (met) {
        answer.hit = true;
        return true;
    }
    HWY_ALIGN double t[mesh::kMeshLeafWidth];
    bool found = false;
    const HitBits hits = triangle_hits(leaf, q, wanted, t);
    for (std::uint32_t lanes = (hits.met | hits.open) & wanted; lanes != 0; lanes &= lanes - 1) {
        const auto lane = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes));
        if (!is_before(t[lane], leaf.triangle[lane], answer)) continue;
        if ((hits.open >> lane & 1u) && !meets(index, lane)) continue;
        answer = {t[lane], leaf.triangle[lane], true};
        found = true;
        if (q.any) return true;
    }
    return found;
}

}  // namespace crofton::mesh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
