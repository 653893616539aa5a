// SPDX-License-Identifier: MIT
// A line against the eight children of a node and the triangles of a leaf. Included once per instruction set.
#if defined(CROFTON_RADIOSITY_LINE_TESTS) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_RADIOSITY_LINE_TESTS
#undef CROFTON_RADIOSITY_LINE_TESTS
#else
#define CROFTON_RADIOSITY_LINE_TESTS
#endif

#include <hwy/highway.h>
#include <crofton/simd/mask_bits-inl.hpp>

#include "trace_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::lines::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
namespace simd = crofton::simd::HWY_NAMESPACE;
using D = hn::CappedTag<float, kLanes>;
using V = hn::Vec<D>;

// A line, each of its numbers in all lanes.
struct Spread {
    V point[3], direction[3], inverse[3];
    HWY_INLINE Spread(D d, const FlatRay& ray) {
        for (int k = 0; k < 3; ++k) {
            point[k] = hn::Set(d, ray.point[k]);
            direction[k] = hn::Set(d, ray.direction[k]);
            inverse[k] = hn::Set(d, 1.0f / ray.direction[k]);
        }
    }
};

// Finds the children that the line passes between t_low and t_high, and where it enters each. Each of the three steps
// of a plane's parameter rounds by 2^-24; widening the interval by 2^-21 of its ends covers them.
HWY_INLINE unsigned children(D d, const mesh::BoxNode& node, const Spread& ray, float t_low, float t_high,
                             float* entry) {
    unsigned bits = 0;
    for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
        V enter = hn::Set(d, t_low), leave = hn::Set(d, t_high);
        for (int k = 0; k < 3; ++k) {
            const V a = hn::Mul(hn::Sub(hn::Load(d, node.bounds[k] + i), ray.point[k]), ray.inverse[k]);
            const V b = hn::Mul(hn::Sub(hn::Load(d, node.bounds[k + 3] + i), ray.point[k]), ray.inverse[k]);
            enter = hn::Max(enter, hn::Min(a, b));
            leave = hn::Min(leave, hn::Max(a, b));
        }
        const V error_bound = hn::Mul(hn::Set(d, 0x1p-21f), hn::Max(hn::Abs(enter), hn::Abs(leave)));
        hn::Store(enter, d, entry + i);
        bits |= simd::mask_bits(d, hn::Le(enter, hn::Add(leave, error_bound))) << i;
    }
    return bits & ((1u << node.count) - 1u);
}

// Möller and Trumbore, both sides. `determinant` > 0: the line runs against the normal.
template <class T, class U = hn::Vec<T>>
HWY_INLINE hn::Mask<T> meet(T d, const U* corner, const U* e1, const U* e2, const U* point, const U* direction,
                            U* determinant, U* t) {
    const U zero = hn::Zero(d);
    U s[3], p[3], q[3];
    for (int k = 0; k < 3; ++k) s[k] = hn::Sub(point[k], corner[k]);
    const auto cross = [](const U* a, const U* b, U* out) {
        out[0] = hn::Sub(hn::Mul(a[1], b[2]), hn::Mul(a[2], b[1]));
        out[1] = hn::Sub(hn::Mul(a[2], b[0]), hn::Mul(a[0], b[2]));
        out[2] = hn::Sub(hn::Mul(a[0], b[1]), hn::Mul(a[1], b[0]));
    };
    const auto dot = [](const U* a, const U* b) {
        return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2]));
    };
    cross(direction, e2, p);
    *determinant = dot(e1, p);
    const U scale = hn::Div(hn::Set(d, 1.0f), *determinant);
    const U u = hn::Mul(dot(s, p), scale);
    cross(s, e1, q);
    const U v = hn::Mul(dot(direction, q), scale);
    *t = hn::Mul(dot(e2, q), scale);
    return hn::And(hn::And(hn::Ge(u, zero), hn::Ge(v, zero)),
                   hn::And(hn::Le(hn::Add(u, v), hn::Set(d, 1.0f)), hn::Ne(*determinant, zero)));
}

// A line against the triangles of a leaf from lane i on.
HWY_INLINE hn::Mask<D> meet_lanes(D d, const TracerLeaf& leaf, std::size_t i, const V* point, const V* direction,
                                  V* determinant, V* t) {
    V corner[3], e1[3], e2[3];
    for (int k = 0; k < 3; ++k) {
        corner[k] = hn::Load(d, leaf.corner[k] + i);
        e1[k] = hn::Load(d, leaf.first[k] + i);
        e2[k] = hn::Load(d, leaf.second[k] + i);
    }
    return meet(d, corner, e1, e2, point, direction, determinant, t);
}

// All triangles of a leaf: those that are met, and where. `front`: the line runs against the normal.
HWY_INLINE unsigned triangles(D d, const TracerLeaf& leaf, const Spread& ray, float* t_out, unsigned* front) {
    unsigned bits = 0;
    *front = 0;
    for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
        V determinant, t;
        const auto inside = meet_lanes(d, leaf, i, ray.point, ray.direction, &determinant, &t);
        hn::Store(t, d, t_out + i);
        bits |= simd::mask_bits(d, inside) << i;
        *front |= simd::mask_bits(d, hn::Gt(determinant, hn::Zero(d))) << i;
    }
    return bits;
}

constexpr float kFar = 3e38f;

// Where two faces back to back coincide, rounding must not put the back one in front.
HWY_INLINE float sort_key(const FlatHit& hit, float tie) {
    return (hit.triangle & kFront) ? hit.t : hit.t + tie;
}

}  // namespace crofton::lines::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
