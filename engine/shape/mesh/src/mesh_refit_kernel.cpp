// SPDX-License-Identifier: MIT
// Boxes that follow their vertices, compiled for each instruction set and chosen at run time.
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include <hwy/cache_control.h>
#include <hwy/highway.h>
#include <cstring>

#include "box_anchors.hpp"
#include "mesh_refit.hpp"

// No operation is fused and minima do not depend on their order, so that all instruction sets give the same bits.
HWY_BEFORE_NAMESPACE();
namespace crofton::mesh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D16 = hn::CappedTag<float, kMeshNodeWidth>;
using V16 = hn::Vec<D16>;
using D8 = hn::CappedTag<float, kMeshLeafWidth>;
using V8 = hn::Vec<D8>;

struct Vector3 {
    V16 x, y, z;
};
HWY_INLINE Vector3 difference(const float (&u)[3][kMeshNodeWidth], const float (&v)[3][kMeshNodeWidth], std::size_t l) {
    const D16 d;
    return {hn::Sub(hn::Load(d, u[0] + l), hn::Load(d, v[0] + l)),
            hn::Sub(hn::Load(d, u[1] + l), hn::Load(d, v[1] + l)),
            hn::Sub(hn::Load(d, u[2] + l), hn::Load(d, v[2] + l))};
}
HWY_INLINE V16 dot(const Vector3& u, const Vector3& v) {
    return hn::Add(hn::Add(hn::Mul(u.x, v.x), hn::Mul(u.y, v.y)), hn::Mul(u.z, v.z));
}
HWY_INLINE Vector3 scaled(const Vector3& u, V16 by) {
    return {hn::Mul(u.x, by), hn::Mul(u.y, by), hn::Mul(u.z, by)};
}
HWY_INLINE Vector3 cross(const Vector3& u, const Vector3& v) {
    return {hn::Sub(hn::Mul(u.y, v.z), hn::Mul(u.z, v.y)), hn::Sub(hn::Mul(u.z, v.x), hn::Mul(u.x, v.z)),
            hn::Sub(hn::Mul(u.x, v.y), hn::Mul(u.y, v.x))};
}
HWY_INLINE Vector3 unit(const Vector3& u) {
    return scaled(u, hn::Div(hn::Set(D16(), 1.0f), hn::Sqrt(dot(u, u))));
}
HWY_INLINE Vector3 choose(hn::Mask<D16> mask, const Vector3& yes, const Vector3& no) {
    return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z)};
}
// A multiple whose largest component is ±1, so that squares stay within float; zero or tiny vectors give `instead`.
HWY_INLINE Vector3 brought_to_one(const Vector3& u, const Vector3& instead) {
    const D16 d;
    const V16 most = hn::Max(hn::Abs(u.x), hn::Max(hn::Abs(u.y), hn::Abs(u.z)));
    return choose(hn::Gt(most, hn::Set(d, 1e-37f)), scaled(u, hn::Div(hn::Set(d, 1.0f), most)), instead);
}

void FindFrames(const AnchorPoints& points, AnchorFrames& frames) {
    const D16 d;
    const V16 zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    for (std::size_t l = 0; l < kMeshNodeWidth; l += hn::Lanes(d)) {
        const Vector3 u = unit(brought_to_one(difference(points.b, points.a, l), {one, zero, zero}));
        const Vector3 to_c = brought_to_one(difference(points.c, points.a, l), u);
        Vector3 normal = cross(u, to_c);
        // Collinear points: across u and the coordinate axis along which u has its least component, or nearly.
        const auto x_is_small = hn::Lt(hn::Abs(u.x), hn::Set(d, 0.57f));
        const Vector3 any = cross(u, choose(x_is_small, {one, zero, zero}, {zero, one, zero}));
        normal = unit(choose(hn::Gt(dot(normal, normal), hn::Set(d, 1e-6f)), normal, any));
        // What rounding left of u goes.
        const V16 along = dot(normal, u);
        normal = unit({hn::Sub(normal.x, hn::Mul(along, u.x)), hn::Sub(normal.y, hn::Mul(along, u.y)),
                       hn::Sub(normal.z, hn::Mul(along, u.z))});
        const Vector3 v = cross(normal, u);
        const Vector3* const axes[3] = {&u, &v, &normal};
        for (int k = 0; k < 3; ++k) {
            hn::Store(axes[k]->x, d, frames.axes[k][0] + l);
            hn::Store(axes[k]->y, d, frames.axes[k][1] + l);
            hn::Store(axes[k]->z, d, frames.axes[k][2] + l);
        }
    }
}

float MoveLeaves(const float* positions, const LeafVertices* vertices, std::size_t count, MeshLeaf* leaves) {
    constexpr std::size_t kAhead = 4;
    const D8 d;
    V8 most = hn::Zero(d);
    for (std::size_t n = 0; n < count; ++n) {
        const LeafVertices& from = vertices[n];
        MeshLeaf& leaf = leaves[n];
        if (n + kAhead < count)
            for (std::size_t lane = 0; lane < kMeshLeafWidth; ++lane)
                hwy::Prefetch(positions + 3 * std::size_t{vertices[n + kAhead].vertex[0][lane]});
        for (int v = 0; v < 3; ++v) {
            for (std::size_t lane = 0; lane < kMeshLeafWidth; ++lane) {
                const float* const p = positions + 3 * std::size_t{from.vertex[v][lane]};
                leaf.vertex[v][0][lane] = p[0];
                leaf.vertex[v][1][lane] = p[1];
                leaf.vertex[v][2][lane] = p[2];
            }
            for (int i = 0; i < 3; ++i)
                for (std::size_t l = 0; l < kMeshLeafWidth; l += hn::Lanes(d))
                    most = hn::Max(most, hn::Abs(hn::Load(d, leaf.vertex[v][i] + l)));
        }
    }
    return hn::GetLane(hn::MaxOfLanes(d, most));
}

// Of one box: its axes, a point near its triangles, and the bounds of these along the axes, relative to that point.
struct Slabs {
    float axes[3][3], origin[3], low[3], high[3];
};

HWY_INLINE void find_bounds(const MeshLeaf* begin, const MeshLeaf* end, Slabs& slabs) {
    const D8 d;
    V8 low[3], high[3], origin[3], axis[3][3];
    for (int k = 0; k < 3; ++k) {
        low[k] = hn::Set(d, 3e38f);
        high[k] = hn::Set(d, -3e38f);
        origin[k] = hn::Set(d, slabs.origin[k]);
        for (int i = 0; i < 3; ++i) axis[k][i] = hn::Set(d, slabs.axes[k][i]);
    }
    for (const MeshLeaf* leaf = begin; leaf != end; ++leaf)
        for (int v = 0; v < 3; ++v)
            for (std::size_t l = 0; l < kMeshLeafWidth; l += hn::Lanes(d)) {
                const V8 x = hn::Sub(hn::Load(d, leaf->vertex[v][0] + l), origin[0]),
                         y = hn::Sub(hn::Load(d, leaf->vertex[v][1] + l), origin[1]),
                         z = hn::Sub(hn::Load(d, leaf->vertex[v][2] + l), origin[2]);
                for (int k = 0; k < 3; ++k) {
                    const V8 along =
                        hn::Add(hn::Add(hn::Mul(axis[k][0], x), hn::Mul(axis[k][1], y)), hn::Mul(axis[k][2], z));
                    low[k] = hn::Min(low[k], along);
                    high[k] = hn::Max(high[k], along);
                }
            }
    for (int k = 0; k < 3; ++k) {
        slabs.low[k] = hn::GetLane(hn::MinOfLanes(d, low[k]));
        slabs.high[k] = hn::GetLane(hn::MaxOfLanes(d, high[k]));
    }
}

// The smallest float ≥ a positive value.
HWY_INLINE float float_above(double value) {
    float rounded = static_cast<float>(value);
    if (static_cast<double>(rounded) < value) {
        std::uint32_t bits;
        std::memcpy(&bits, &rounded, sizeof(bits));
        ++bits;
        std::memcpy(&rounded, &bits, sizeof(bits));
    }
    return rounded;
}

// With H the sum of the half extents, points lie within 3.5 H of each other, in sum of coordinates. A difference, a
// product and two sums in float are off by 4 · 2^-24 of that: 8.4e-7 H at either end. Axes that are orthonormal
// to 1.5e-6 bound the points along themselves, not along the box's edges: 3 · 1.5e-6 H. The margin is 6e-6 H.
HWY_INLINE void store_box(const Slabs& slabs, std::uint32_t lane, MeshNode& node) {
    double middle[3], half[3], center[3];
    for (int k = 0; k < 3; ++k)
        middle[k] = 0.5 * (static_cast<double>(slabs.low[k]) + static_cast<double>(slabs.high[k]));
    for (int i = 0; i < 3; ++i) {
        double place = static_cast<double>(slabs.origin[i]);
        for (int k = 0; k < 3; ++k) place += static_cast<double>(slabs.axes[k][i]) * middle[k];
        node.center[i][lane] = static_cast<float>(place);
        center[i] = static_cast<double>(node.center[i][lane]) - static_cast<double>(slabs.origin[i]);
    }
    for (int k = 0; k < 3; ++k) {
        double along = 0.0;
        for (int i = 0; i < 3; ++i) along += static_cast<double>(slabs.axes[k][i]) * center[i];
        half[k] = HWY_MAX(static_cast<double>(slabs.high[k]) - along, along - static_cast<double>(slabs.low[k]));
    }
    const double margin = 6e-6 * (half[0] + half[1] + half[2]) + 1e-37;
    for (int k = 0; k < 3; ++k) {
        node.half[k][lane] = float_above(half[k] + margin);
        for (int i = 0; i < 3; ++i) node.axes[k][i][lane] = slabs.axes[k][i];
    }
}

// Axes of all lanes: frames times the anchors' axes.
HWY_INLINE void turn_axes(const AnchorFrames& frames, const BoxAnchors& anchors, AnchorFrames& axes) {
    const D16 d;
    for (std::size_t l = 0; l < kMeshNodeWidth; l += hn::Lanes(d))
        for (int k = 0; k < 3; ++k)
            for (int i = 0; i < 3; ++i) {
                V16 sum = hn::Mul(hn::Load(d, frames.axes[0][i] + l), hn::Load(d, anchors.axes[k][0] + l));
                for (int f = 1; f < 3; ++f)
                    sum =
                        hn::Add(sum, hn::Mul(hn::Load(d, frames.axes[f][i] + l), hn::Load(d, anchors.axes[k][f] + l)));
                hn::Store(sum, d, axes.axes[k][i] + l);
            }
}

void RefitBoxes(const float* positions, const MeshLeaf* leaves, const BoxAnchors& anchors, MeshNode& node) {
    AnchorPoints points;
    for (std::size_t lane = 0; lane < kMeshNodeWidth; ++lane) {
        const std::size_t used = HWY_MIN(lane, std::size_t{node.count} - 1);
        const float *const a = positions + 3 * std::size_t{anchors.vertex[0][used]},
                           *const b = positions + 3 * std::size_t{anchors.vertex[1][used]},
                           *const c = positions + 3 * std::size_t{anchors.vertex[2][used]};
        for (int i = 0; i < 3; ++i) {
            points.a[i][lane] = a[i];
            points.b[i][lane] = b[i];
            points.c[i][lane] = c[i];
        }
    }
    AnchorFrames frames, axes;
    FindFrames(points, frames);
    turn_axes(frames, anchors, axes);
    for (std::uint32_t lane = 0; lane < node.count; ++lane) {
        Slabs slabs;
        for (int k = 0; k < 3; ++k) {
            slabs.origin[k] = points.a[k][lane];
            for (int i = 0; i < 3; ++i) slabs.axes[k][i] = axes.axes[k][i][lane];
        }
        find_bounds(leaves + anchors.first_leaf[lane], leaves + anchors.end_leaf[lane], slabs);
        store_box(slabs, lane, node);
    }
}

}  // namespace crofton::mesh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::mesh {

HWY_EXPORT(FindFrames);
HWY_EXPORT(MoveLeaves);
HWY_EXPORT(RefitBoxes);

void find_frames(const AnchorPoints& points, AnchorFrames& frames) {
    HWY_DYNAMIC_DISPATCH(FindFrames)(points, frames);
}
float move_leaves(const float* positions, const LeafVertices* vertices, std::size_t count, MeshLeaf* leaves) {
    return HWY_DYNAMIC_DISPATCH(MoveLeaves)(positions, vertices, count, leaves);
}
void refit_boxes(const float* positions, const MeshLeaf* leaves, const BoxAnchors& anchors, MeshNode& node) {
    HWY_DYNAMIC_DISPATCH(RefitBoxes)(positions, leaves, anchors, node);
}

}  // namespace crofton::mesh
#endif
