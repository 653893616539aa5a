// SPDX-License-Identifier: MIT
// One box against the sixteen of a node; included once per instruction set.
#if defined(CROFTON_COLLIDE_MESH_KERNELS) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_COLLIDE_MESH_KERNELS
#undef CROFTON_COLLIDE_MESH_KERNELS
#else
#define CROFTON_COLLIDE_MESH_KERNELS
#endif

#include <hwy/highway.h>
#include <cmath>
#include <crofton/simd/mask_bits-inl.hpp>

#include "mesh_pair.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::mesh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace simd = crofton::simd::HWY_NAMESPACE;

using D = hn::CappedTag<float, mesh::kMeshNodeWidth>;
using V = hn::Vec<D>;

// Rounding of the products and sums of one test, relative to the boxes' sizes: 16 roundings of 2^-24 at most, axes
// orthonormal to 1.5e-6, and a margin.
constexpr float kBoxError = 4e-6f;

// A box, its rows padded for vector loads.
struct QueryBox {
    alignas(16) float center[4];
    alignas(16) float axes[3][4];
    float half[3];
};

HWY_INLINE float half_sum(const QueryBox& box) {
    return box.half[0] + box.half[1] + box.half[2];
}

HWY_INLINE QueryBox box_of(const mesh::MeshNode& node, std::uint32_t lane) {
    QueryBox box;
    for (int k = 0; k < 3; ++k) {
        box.center[k] = node.center[k][lane];
        box.half[k] = node.half[k][lane];
        for (int i = 0; i < 3; ++i) box.axes[k][i] = node.axes[k][i][lane];
    }
    return box;
}

HWY_INLINE QueryBox box_of(const mesh::MeshBox& root) {
    QueryBox box;
    for (int k = 0; k < 3; ++k) {
        box.center[k] = root.center[k];
        box.half[k] = root.half[k];
        for (int i = 0; i < 3; ++i) box.axes[k][i] = root.axes[k][i];
    }
    return box;
}

// motion's linear part times v.
HWY_INLINE void turn(const MeshPair::Motion& motion, const float* v, float* out) {
    const hn::CappedTag<float, 4> d;
    for (std::size_t l = 0; l < 4; l += hn::Lanes(d)) {
        const auto column = [&](int i) HWY_ATTR { return hn::Load(d, motion.column[i] + l); };
        hn::Store(hn::MulAdd(column(0), hn::Set(d, v[0]),
                             hn::MulAdd(column(1), hn::Set(d, v[1]), hn::Mul(column(2), hn::Set(d, v[2])))),
                  d, out + l);
    }
}

HWY_INLINE void carry_point(const MeshPair::Motion& motion, const float* p, float* out) {
    turn(motion, p, out);
    for (int i = 0; i < 3; ++i) out[i] += motion.offset[i];
}

// The box in the other mesh's frame.
HWY_INLINE QueryBox carried(const MeshPair::Motion& motion, const QueryBox& from) {
    QueryBox box;
    carry_point(motion, from.center, box.center);
    for (int k = 0; k < 3; ++k) {
        turn(motion, from.axes[k], box.axes[k]);
        box.half[k] = from.half[k];
    }
    return box;
}

// What all tests of a box q against a node's lanes begin with: q's axes dotted with the lanes' axes and offsets.
struct Lanes {
    V t[3];     // offset along q's axes
    V r[3][3];  // q.axis i · lane axis j
    V magnitude[3][3];
    V half[3];
    V error;
};

HWY_INLINE Lanes prepare(D d, const mesh::MeshNode& node, std::size_t l, const QueryBox& q, float margin) {
    Lanes s;
    V offset[3], axis[3][3];
    for (int i = 0; i < 3; ++i) {
        offset[i] = hn::Sub(hn::Load(d, node.center[i] + l), hn::Set(d, q.center[i]));
        s.half[i] = hn::Load(d, node.half[i] + l);
        for (int j = 0; j < 3; ++j) axis[j][i] = hn::Load(d, node.axes[j][i] + l);
    }
    for (int i = 0; i < 3; ++i) {
        const V x = hn::Set(d, q.axes[i][0]), y = hn::Set(d, q.axes[i][1]), z = hn::Set(d, q.axes[i][2]);
        s.t[i] = hn::MulAdd(x, offset[0], hn::MulAdd(y, offset[1], hn::Mul(z, offset[2])));
        for (int j = 0; j < 3; ++j) {
            s.r[i][j] = hn::MulAdd(x, axis[j][0], hn::MulAdd(y, axis[j][1], hn::Mul(z, axis[j][2])));
            s.magnitude[i][j] = hn::Abs(s.r[i][j]);
        }
    }
    const V sum = hn::Add(s.half[0], hn::Add(s.half[1], s.half[2]));
    s.error = hn::MulAdd(sum, hn::Set(d, kBoxError), hn::Set(d, kBoxError * half_sum(q) + margin));
    return s;
}

// The gap along face normal i of q, and along face normal j of the lanes; negative: overlap.
HWY_INLINE V gap_of_query_face(D d, const Lanes& s, const QueryBox& q, int i) {
    const V projected_radius = hn::MulAdd(
        s.half[0], s.magnitude[i][0],
        hn::MulAdd(s.half[1], s.magnitude[i][1], hn::MulAdd(s.half[2], s.magnitude[i][2], hn::Set(d, q.half[i]))));
    return hn::Sub(hn::Abs(s.t[i]), hn::Add(projected_radius, s.error));
}
HWY_INLINE V gap_of_lane_face(D d, const Lanes& s, const QueryBox& q, int j) {
    const V along = hn::MulAdd(s.t[0], s.r[0][j], hn::MulAdd(s.t[1], s.r[1][j], hn::Mul(s.t[2], s.r[2][j])));
    const V projected_radius =
        hn::MulAdd(hn::Set(d, q.half[0]), s.magnitude[0][j],
                   hn::MulAdd(hn::Set(d, q.half[1]), s.magnitude[1][j],
                              hn::MulAdd(hn::Set(d, q.half[2]), s.magnitude[2][j], hn::Add(s.half[j], s.error))));
    return hn::Sub(hn::Abs(along), projected_radius);
}

// Bit l is set unless lane l's box is surely farther than `margin` from q. Edge axes are not of unit length: there
// `margin`, like the error, counts in full, which is on the safe side.
HWY_INLINE std::uint32_t overlap_mask(const mesh::MeshNode& node, const QueryBox& q, float margin) {
    const D d;
    std::uint32_t apart = 0;
    for (std::size_t l = 0; l < mesh::kMeshNodeWidth; l += hn::Lanes(d)) {
        const Lanes s = prepare(d, node, l, q, margin);
        V gap = gap_of_query_face(d, s, q, 0);
        gap = hn::Max(gap, hn::Max(gap_of_query_face(d, s, q, 1), gap_of_query_face(d, s, q, 2)));
        gap = hn::Max(gap, gap_of_lane_face(d, s, q, 0));
        gap = hn::Max(gap, hn::Max(gap_of_lane_face(d, s, q, 1), gap_of_lane_face(d, s, q, 2)));
        const V zero = hn::Zero(d);
        if (!hn::AllTrue(d, hn::Gt(gap, zero))) {
            for (int i = 0; i < 3; ++i) {
                const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
                const V h1 = hn::Set(d, q.half[i1]), h2 = hn::Set(d, q.half[i2]);
                for (int j = 0; j < 3; ++j) {
                    const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
                    const V along = hn::Abs(hn::NegMulAdd(s.t[i1], s.r[i2][j], hn::Mul(s.t[i2], s.r[i1][j])));
                    const V projected_radius =
                        hn::MulAdd(h1, s.magnitude[i2][j],
                                   hn::MulAdd(h2, s.magnitude[i1][j],
                                              hn::MulAdd(s.half[j1], s.magnitude[i][j2],
                                                         hn::MulAdd(s.half[j2], s.magnitude[i][j1], s.error))));
                    gap = hn::Max(gap, hn::Sub(along, projected_radius));
                }
            }
        }
        apart |= simd::mask_bits(d, hn::Gt(gap, zero)) << l;
    }
    return ~apart & ((1u << node.count) - 1u);
}

// A unit vector, or zero, in the frame of a node, and how far what is tested against its lanes reaches along it, from
// its box's centre.
struct Direction {
    alignas(16) float way[4];
    float low, high;
};

HWY_INLINE float along(const float* a, const float* b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

HWY_INLINE void direction_between(const float* from, const float* to, float* way) {
    float squared = 0.0f;
    for (int i = 0; i < 3; ++i) squared += (to[i] - from[i]) * (to[i] - from[i]);
    const float per_length = squared > 1e-30f ? 1.0f / std::sqrt(squared) : 0.0f;
    for (int i = 0; i < 3; ++i) way[i] = (to[i] - from[i]) * per_length;
}

HWY_INLINE void measure(const QueryBox& q, Direction& direction) {
    direction.high = 0.0f;
    for (int k = 0; k < 3; ++k) {
        const float projected_radius = q.half[k] * along(q.axes[k], direction.way);
        direction.high += projected_radius < 0.0f ? -projected_radius : projected_radius;
    }
    direction.low = -direction.high;
}

HWY_INLINE void measure(const QueryBox& q, const float (&corner)[3][4], Direction& direction) {
    for (int v = 0; v < 3; ++v) {
        const float offset[3] = {corner[v][0] - q.center[0], corner[v][1] - q.center[1], corner[v][2] - q.center[2]};
        const float at = along(offset, direction.way);
        direction.low = v == 0 ? at : HWY_MIN(direction.low, at);
        direction.high = v == 0 ? at : HWY_MAX(direction.high, at);
    }
}

// The gap along any unit direction bounds the distance from below. Along that of the nearest points found so far hardly
// anything far from them remains. Rounding of the projection scales with the offset, which may be long: 2^-20 of it.
HWY_INLINE V gap_along(D d, const mesh::MeshNode& node, std::size_t l, const Lanes& s, const QueryBox& q,
                       const Direction& direction) {
    V shift = hn::Zero(d), length = hn::Zero(d), projected_radius = s.error;
    for (int i = 0; i < 3; ++i) {
        const V offset = hn::Sub(hn::Load(d, node.center[i] + l), hn::Set(d, q.center[i]));
        shift = hn::MulAdd(offset, hn::Set(d, direction.way[i]), shift);
        length = hn::Add(length, hn::Abs(offset));
    }
    for (int k = 0; k < 3; ++k) {
        V axis_along = hn::Zero(d);
        for (int i = 0; i < 3; ++i)
            axis_along = hn::MulAdd(hn::Load(d, node.axes[k][i] + l), hn::Set(d, direction.way[i]), axis_along);
        projected_radius = hn::MulAdd(s.half[k], hn::Abs(axis_along), projected_radius);
    }
    const V ahead = hn::Sub(shift, hn::Set(d, direction.high)), behind = hn::Sub(hn::Set(d, direction.low), shift);
    return hn::Sub(hn::Max(ahead, behind), hn::MulAdd(length, hn::Set(d, 0x1p-20f), projected_radius));
}

// A lower bound of the squared distance of q to each lane's box. In either frame the gaps along the three perpendicular
// face normals add up by Pythagoras. The last factor covers the rounding of the squares.
HWY_INLINE void distance_bounds(const mesh::MeshNode& node, const QueryBox& q, float margin, const Direction& first,
                                const Direction& second, float* bounds) {
    const D d;
    const V zero = hn::Zero(d);
    for (std::size_t l = 0; l < mesh::kMeshNodeWidth; l += hn::Lanes(d)) {
        const Lanes s = prepare(d, node, l, q, margin);
        V in_query = zero, in_lane = zero;
        for (int k = 0; k < 3; ++k) {
            const V a = hn::Max(zero, gap_of_query_face(d, s, q, k)), b = hn::Max(zero, gap_of_lane_face(d, s, q, k));
            in_query = hn::MulAdd(a, a, in_query);
            in_lane = hn::MulAdd(b, b, in_lane);
        }
        const V gap = hn::Max(zero, hn::Max(gap_along(d, node, l, s, q, first), gap_along(d, node, l, s, q, second)));
        const V squared = hn::Max(hn::Mul(gap, gap), hn::Max(in_query, in_lane));
        hn::Store(hn::Mul(squared, hn::Set(d, 0.99999f)), d, bounds + l);
    }
}

}  // namespace crofton::mesh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
