// SPDX-License-Identifier: MIT
// Tests one box against a mesh tree, compiled for each instruction set and chosen at run time.
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include <hwy/highway.h>
#include <cmath>
#include <crofton/mesh/near_triangles.hpp>

#include "mesh_kernels-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::mesh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using DT = hn::CappedTag<float, kMeshLeafWidth>;
using VT = hn::Vec<DT>;

// Bit l is set unless triangle l is surely farther than `margin` from the box along one of the box's axes. A product
// with an axis is off by 2^-21 of the sum of magnitudes of the offset.
HWY_INLINE std::uint32_t near_triangles(const MeshLeaf& leaf, const QueryBox& q, float margin) {
    const DT d;
    std::uint32_t apart = 0;
    const float query_margin = (half_sum(q) * kBoxError) + margin;
    for (std::size_t l = 0; l < kMeshLeafWidth; l += hn::Lanes(d)) {
        VT offset[3][3], size = hn::Zero(d);
        for (int v = 0; v < 3; ++v)
            for (int i = 0; i < 3; ++i) {
                offset[v][i] = hn::Sub(hn::Load(d, leaf.vertex[v][i] + l), hn::Set(d, q.center[i]));
                size = hn::Add(size, hn::Abs(offset[v][i]));
            }
        VT gap = hn::Set(d, -1.0f);
        for (int k = 0; k < 3; ++k) {
            VT low = hn::Zero(d), high = hn::Zero(d);
            for (int v = 0; v < 3; ++v) {
                const VT at = hn::MulAdd(offset[v][0], hn::Set(d, q.axes[k][0]),
                                         hn::MulAdd(offset[v][1], hn::Set(d, q.axes[k][1]),
                                                    hn::Mul(offset[v][2], hn::Set(d, q.axes[k][2]))));
                low = v == 0 ? at : hn::Min(low, at);
                high = v == 0 ? at : hn::Max(high, at);
            }
            gap = hn::Max(gap, hn::Sub(hn::Max(low, hn::Neg(high)), hn::Set(d, q.half[k])));
        }
        const VT error = hn::MulAdd(size, hn::Set(d, 0x1p-20f), hn::Set(d, query_margin));
        apart |= simd::mask_bits(d, hn::Gt(gap, error)) << l;
    }
    return ~apart & ((1u << leaf.count) - 1u);
}

void VisitNear(const MeshNode* nodes, const MeshLeaf* leaves, const MeshBox& box, float margin, TriangleVisitor visit) {
    const QueryBox q = box_of(box);
    std::uint32_t stack[kMeshStackSize], height = 0;
    stack[height++] = 0;
    while (height > 0) {
        const std::uint32_t child = stack[--height];
        if (child & kMeshLeaf) {
            const MeshLeaf& leaf = leaves[child & ~kMeshLeaf];
            for (std::uint32_t lanes = near_triangles(leaf, q, margin); lanes != 0; lanes &= lanes - 1)
                if (visit(leaf, static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes)))) return;
            continue;
        }
        for (std::uint32_t mask = overlap_mask(nodes[child], q, margin); mask != 0; mask &= mask - 1)
            stack[height++] = nodes[child].child[hwy::Num0BitsBelowLS1Bit_Nonzero32(mask)];
    }
}

void VisitNearestTo(const MeshNode* nodes, const MeshLeaf* leaves, const MeshBox& box, float margin,
                    const double& squared, TriangleVisitor visit) {
    struct Waiting {
        std::uint32_t child;
        float bound;
    };
    const QueryBox q = box_of(box);
    Waiting stack[kMeshStackSize];
    std::uint32_t height = 0;
    stack[height++] = {0, 0.0f};
    while (height > 0) {
        const Waiting next = stack[--height];
        if (static_cast<double>(next.bound) > squared) continue;
        if (next.child & kMeshLeaf) {
            const MeshLeaf& leaf = leaves[next.child & ~kMeshLeaf];
            const double far = squared < 1e30 ? std::sqrt(squared) : 1e15;
            for (std::uint32_t lanes = near_triangles(leaf, q, static_cast<float>(far * 1.000001) + margin); lanes != 0;
                 lanes &= lanes - 1)
                if (visit(leaf, static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes)))) return;
            continue;
        }
        const MeshNode& node = nodes[next.child];
        HWY_ALIGN float bounds[kMeshNodeWidth];
        Direction none{};
        distance_bounds(node, q, margin, none, none, bounds);
        // The nearest child goes on top; insertion keeps equal ones in lane order.
        const std::uint32_t base = height;
        for (std::uint32_t lane = 0; lane < node.count; ++lane) {
            if (static_cast<double>(bounds[lane]) > squared) continue;
            std::uint32_t place = height++;
            for (; place > base && stack[place - 1].bound < bounds[lane]; --place) stack[place] = stack[place - 1];
            stack[place] = {node.child[lane], bounds[lane]};
        }
    }
}

}  // namespace crofton::mesh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::mesh {

HWY_EXPORT(VisitNear);
HWY_EXPORT(VisitNearestTo);

void visit_triangles_near(const MeshNode* nodes, const MeshLeaf* leaves, const MeshBox& box, float margin,
                          TriangleVisitor visit) {
    HWY_DYNAMIC_DISPATCH(VisitNear)(nodes, leaves, box, margin, visit);
}

void visit_nearest_triangles(const MeshNode* nodes, const MeshLeaf* leaves, const MeshBox& box, float margin,
                             const double& squared, TriangleVisitor visit) {
    HWY_DYNAMIC_DISPATCH(VisitNearestTo)(nodes, leaves, box, margin, squared, visit);
}

}  // namespace crofton::mesh
#endif
