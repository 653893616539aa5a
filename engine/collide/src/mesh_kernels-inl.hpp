// One box against the eight of a node, one triangle against the eight of a leaf; included once per instruction set.
#if defined(CROFTON_COLLIDE_MESH_KERNELS) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_COLLIDE_MESH_KERNELS
#undef CROFTON_COLLIDE_MESH_KERNELS
#else
#define CROFTON_COLLIDE_MESH_KERNELS
#endif

#include <hwy/highway.h>

#include "mesh_pair.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::collide::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, tree::kMeshWidth>;
using V = hn::Vec<D>;

// Rounding of the products and sums of one test, relative to the boxes' sizes: 16 roundings of 2^-24 at most, axes
// orthonormal to 1e-6, and a margin.
constexpr float kBoxError = 4e-6f;

HWY_INLINE float half_sum(const tree::MeshBox& box) {
    return box.half[0] + box.half[1] + box.half[2];
}

HWY_INLINE tree::MeshBox box_of(const tree::MeshNode& node, std::uint32_t lane) {
    tree::MeshBox box;
    for (int k = 0; k < 3; ++k) {
        box.center[k] = node.center[k][lane];
        box.half[k] = node.half[k][lane];
        for (int i = 0; i < 3; ++i) box.axes[k][i] = node.axes[k][i][lane];
    }
    return box;
}

HWY_INLINE void rotate(const float (&m)[3][3], const float* v, float* out) {
    for (int i = 0; i < 3; ++i) out[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
}

// A box of b in a's frame.
HWY_INLINE tree::MeshBox to_a(const MeshPair& pair, const tree::MeshBox& b) {
    tree::MeshBox box;
    rotate(pair.rotation, b.center, box.center);
    for (int k = 0; k < 3; ++k) {
        box.center[k] += pair.translation[k];
        rotate(pair.rotation, b.axes[k], box.axes[k]);
        box.half[k] = b.half[k];
    }
    return box;
}

// A box of a in b's frame.
HWY_INLINE tree::MeshBox to_b(const MeshPair& pair, const tree::MeshBox& a) {
    float back[3][3], offset[3];
    for (int i = 0; i < 3; ++i) {
        offset[i] = a.center[i] - pair.translation[i];
        for (int j = 0; j < 3; ++j) back[i][j] = pair.rotation[j][i];
    }
    tree::MeshBox box;
    rotate(back, offset, box.center);
    for (int k = 0; k < 3; ++k) {
        rotate(back, a.axes[k], box.axes[k]);
        box.half[k] = a.half[k];
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

HWY_INLINE Lanes prepare(D d, const tree::MeshNode& node, std::size_t l, const tree::MeshBox& q, float slop) {
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
    s.error = hn::MulAdd(sum, hn::Set(d, kBoxError), hn::Set(d, kBoxError * half_sum(q) + slop));
    return s;
}

// The gap along face normal i of q, and along face normal j of the lanes; negative: overlap.
HWY_INLINE V gap_of_query_face(D d, const Lanes& s, const tree::MeshBox& q, int i) {
    const V reach = hn::MulAdd(
        s.half[0], s.magnitude[i][0],
        hn::MulAdd(s.half[1], s.magnitude[i][1], hn::MulAdd(s.half[2], s.magnitude[i][2], hn::Set(d, q.half[i]))));
    return hn::Sub(hn::Abs(s.t[i]), hn::Add(reach, s.error));
}
HWY_INLINE V gap_of_lane_face(D d, const Lanes& s, const tree::MeshBox& q, int j) {
    const V along = hn::MulAdd(s.t[0], s.r[0][j], hn::MulAdd(s.t[1], s.r[1][j], hn::Mul(s.t[2], s.r[2][j])));
    const V reach =
        hn::MulAdd(hn::Set(d, q.half[0]), s.magnitude[0][j],
                   hn::MulAdd(hn::Set(d, q.half[1]), s.magnitude[1][j],
                              hn::MulAdd(hn::Set(d, q.half[2]), s.magnitude[2][j], hn::Add(s.half[j], s.error))));
    return hn::Sub(hn::Abs(along), reach);
}

// Bit l is set unless lane l's box is surely farther than slop from q. Edge axes are not of unit length: there `slop`,
// like the error, counts in full, which is on the safe side.
HWY_INLINE std::uint32_t overlap_mask(const tree::MeshNode& node, const tree::MeshBox& q, float slop) {
    const D d;
    std::uint32_t apart = 0;
    for (std::size_t l = 0; l < tree::kMeshWidth; l += hn::Lanes(d)) {
        const Lanes s = prepare(d, node, l, q, slop);
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
                    const V reach =
                        hn::MulAdd(h1, s.magnitude[i2][j],
                                   hn::MulAdd(h2, s.magnitude[i1][j],
                                              hn::MulAdd(s.half[j1], s.magnitude[i][j2],
                                                         hn::MulAdd(s.half[j2], s.magnitude[i][j1], s.error))));
                    gap = hn::Max(gap, hn::Sub(along, reach));
                }
            }
        }
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(d, hn::Gt(gap, zero), bits);
        apart |= static_cast<std::uint32_t>(bits[0]) << l;
    }
    return ~apart & ((1u << node.count) - 1u);
}

// A lower bound of the squared distance of q to each lane's box: in either frame the gaps along the three perpendicular
// face normals add up by Pythagoras. The last factor covers the rounding of the squares.
HWY_INLINE void distance_bounds(const tree::MeshNode& node, const tree::MeshBox& q, float slop, float* bounds) {
    const D d;
    const V zero = hn::Zero(d);
    for (std::size_t l = 0; l < tree::kMeshWidth; l += hn::Lanes(d)) {
        const Lanes s = prepare(d, node, l, q, slop);
        V in_query = zero, in_lane = zero;
        for (int k = 0; k < 3; ++k) {
            const V a = hn::Max(zero, gap_of_query_face(d, s, q, k)), b = hn::Max(zero, gap_of_lane_face(d, s, q, k));
            in_query = hn::MulAdd(a, a, in_query);
            in_lane = hn::MulAdd(b, b, in_lane);
        }
        hn::Store(hn::Mul(hn::Max(in_query, in_lane), hn::Set(d, 0.99999f)), d, bounds + l);
    }
}

}  // namespace crofton::collide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
