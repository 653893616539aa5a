// SPDX-License-Identifier: MIT
// Tests a point, and a ray from it, against a mesh tree, compiled for each instruction set and chosen at run time.
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include <hwy/highway.h>
#include <cmath>
#include <crofton/mesh/near_triangles.hpp>
#include <span>

#include "mesh_kernels-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::mesh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using DT = hn::CappedTag<float, kMeshLeafWidth>;
using VT = hn::Vec<DT>;

// Of a tree of at most so many leaves each is asked at once: its one node lies in as many cache lines as four leaves.
constexpr std::size_t kFewLeaves = 4;

// Boxes. Products with an axis are off by 2^-21 of the offset, and the offset is at most the distance and the box's
// size: the last factor covers the first, kBoxError the second.
HWY_INLINE void point_bounds(const MeshNode& node, const NearPoint& p, float* bounds) {
    const D d;
    const V zero = hn::Zero(d);
    for (std::size_t l = 0; l < node.count; l += hn::Lanes(d)) {
        V offset[3], half[3];
        for (int i = 0; i < 3; ++i) {
            offset[i] = hn::Sub(hn::Load(d, node.center[i] + l), hn::Set(d, p.at[i]));
            half[i] = hn::Load(d, node.half[i] + l);
        }
        const V error =
            hn::MulAdd(hn::Add(half[0], hn::Add(half[1], half[2])), hn::Set(d, kBoxError), hn::Set(d, p.error));
        V squared = zero;
        for (int k = 0; k < 3; ++k) {
            const V along = hn::MulAdd(hn::Load(d, node.axes[k][0] + l), offset[0],
                                       hn::MulAdd(hn::Load(d, node.axes[k][1] + l), offset[1],
                                                  hn::Mul(hn::Load(d, node.axes[k][2] + l), offset[2])));
            const V gap = hn::Max(zero, hn::Sub(hn::Abs(along), hn::Add(half[k], error)));
            squared = hn::MulAdd(gap, gap, squared);
        }
        hn::Store(hn::Mul(squared, hn::Set(d, 0.99999f)), d, bounds + l);
    }
}

// The distances of eight triangles from a point, between two bounds.
struct LaneDistances {
    HWY_ALIGN float low[kMeshLeafWidth], high[kMeshLeafWidth];
};

// The distance of a triangle whose sides meet at an angle whose sine is at least 1/32 is off by less than 2^-15 of the
// sum of its corners' offsets: the normal by 6 · 2^-24 · 32 of itself, the foot by that much of the offset. Where the
// foot is that near to an edge, the plane and the edges tell the same distance. Of slivers nothing is known.
HWY_INLINE void lane_distances(const MeshLeaf& leaf, const NearPoint& p, LaneDistances& out) {
    const DT d;
    const VT zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    const auto dot = [](const VT(&a)[3], const VT(&b)[3])
                         HWY_ATTR { return hn::MulAdd(a[0], b[0], hn::MulAdd(a[1], b[1], hn::Mul(a[2], b[2]))); };
    const auto cross = [](const VT(&a)[3], const VT(&b)[3], VT(&c)[3]) HWY_ATTR {
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            c[i] = hn::NegMulAdd(a[k], b[j], hn::Mul(a[j], b[k]));
        }
    };
    for (std::size_t l = 0; l < leaf.count; l += hn::Lanes(d)) {
        VT u[3][3], size = hn::Set(d, 1e-30f);
        for (int v = 0; v < 3; ++v)
            for (int i = 0; i < 3; ++i) {
                u[v][i] = hn::Sub(hn::Load(d, leaf.vertex[v][i] + l), hn::Set(d, p.at[i]));
                size = hn::Add(size, hn::Abs(u[v][i]));
            }
        // Scaled to 1, so that products neither overflow nor vanish.
        const VT scale = hn::Div(one, size);
        for (auto& corner : u)
            for (VT& coordinate : corner) coordinate = hn::Mul(coordinate, scale);
        VT edge[3][3], normal[3], turned[3];
        for (int v = 0; v < 3; ++v)
            for (int i = 0; i < 3; ++i) edge[v][i] = hn::Sub(u[v == 2 ? 0 : v + 1][i], u[v][i]);
        cross(edge[0], edge[1], normal);
        const VT normal2 = dot(normal, normal), plane = dot(normal, u[0]);
        VT beyond = zero, squared = hn::Set(d, 4.0f), squared_edges = one;
        for (int v = 0; v < 3; ++v) {
            cross(normal, edge[v], turned);
            beyond = hn::Max(beyond, dot(turned, u[v]));
            const VT edge2 = dot(edge[v], edge[v]);
            if (v < 2) squared_edges = hn::Mul(squared_edges, edge2);
            const VT t = hn::Min(hn::Max(hn::Neg(hn::Div(dot(u[v], edge[v]), edge2)), zero), one);
            VT way[3];
            for (int i = 0; i < 3; ++i) way[i] = hn::MulAdd(t, edge[v][i], u[v][i]);
            squared = hn::Min(squared, dot(way, way));
        }
        squared = hn::IfThenElse(hn::Gt(beyond, zero), squared, hn::Div(hn::Mul(plane, plane), normal2));
        const auto known = hn::Gt(normal2, hn::Mul(hn::Set(d, 0x1p-10f), squared_edges));
        const VT distance = hn::Sqrt(squared), margin = hn::Set(d, 0x1p-15f), error = hn::Set(d, p.error);
        const VT low = hn::MulSub(hn::Sub(distance, margin), size, error),
                 high = hn::MulAdd(hn::Add(distance, margin), size, error);
        hn::Store(hn::IfThenElse(known, low, hn::Set(d, -1.0f)), d, out.low + l);
        hn::Store(hn::IfThenElse(known, high, hn::Set(d, 1e30f)), d, out.high + l);
    }
}

// The search for the nearest triangle. What may be nearest waits until all is bounded: most of it is then surely
// farther than another, and need not be asked.
class NearestSearch {
  public:
    HWY_INLINE NearestSearch(const MeshLeaf* leaves, const NearPoint& point, const double& squared,
                             TriangleVisitor visit)
        : leaves_(leaves), point_(point), squared_(squared), visit_(visit) {}

    // Of a box at the root of `bound`.
    HWY_INLINE bool is_beyond(float bound) const { return bound > far_ * far_ * 1.000001f; }

    HWY_INLINE void add(std::uint32_t index) {
        const MeshLeaf& leaf = leaves_[index];
        LaneDistances distances;
        lane_distances(leaf, point_, distances);
        const DT d;
        VT least = hn::Set(d, far_);
        for (std::size_t l = 0; l < leaf.count; l += hn::Lanes(d))
            least = hn::Min(least, hn::Load(d, distances.high + l));
        far_ = hn::GetLane(hn::MinOfLanes(d, least));
        std::uint32_t lanes = 0;
        for (std::size_t l = 0; l < leaf.count; l += hn::Lanes(d))
            lanes |= simd::mask_bits(d, hn::Le(hn::Load(d, distances.low + l), hn::Set(d, far_))) << l;
        for (lanes &= (1u << leaf.count) - 1u; lanes != 0; lanes &= lanes - 1) {
            const auto lane = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes));
            const float low = distances.low[lane];
            if (low < 0.0f) {  // near, or not known
                ask(index, lane);
                continue;
            }
            if (count_ == kMostWaiting) finish();
            waiting_[count_++] = {index, lane, low};
        }
    }

    HWY_INLINE void finish() {
        for (std::uint32_t i = 0; i < count_; ++i)
            if (waiting_[i].low <= far_) ask(waiting_[i].leaf, waiting_[i].lane);
        count_ = 0;
    }

  private:
    static constexpr std::uint32_t kMostWaiting = 32;
    struct Waiting {
        std::uint32_t leaf, lane;
        float low;
    };

    HWY_INLINE void ask(std::uint32_t leaf, std::uint32_t lane) {
        visit_(leaves_[leaf], lane);
        if (squared_ < 1e30) far_ = HWY_MIN(far_, static_cast<float>(std::sqrt(squared_) * 1.000001));
    }

    const MeshLeaf* leaves_;
    const NearPoint& point_;
    const double& squared_;
    TriangleVisitor visit_;
    float far_ = 1e15f;  // the nearest is not farther
    std::uint32_t count_ = 0;
    Waiting waiting_[kMostWaiting];
};

void VisitNearestToPoint(const MeshNode* nodes, std::span<const MeshLeaf> leaves, const NearPoint& point,
                         const double& squared, TriangleVisitor visit) {
    struct Waiting {
        std::uint32_t child;
        float bound;
    };
    NearestSearch search(leaves.data(), point, squared, visit);
    if (leaves.size() <= kFewLeaves) {
        for (std::uint32_t i = 0; i < leaves.size(); ++i) search.add(i);
        return search.finish();
    }
    Waiting stack[kMeshStackSize];
    std::uint32_t height = 0;
    stack[height++] = {0, 0.0f};
    while (height > 0) {
        const Waiting next = stack[--height];
        if (search.is_beyond(next.bound)) continue;
        if (next.child & kMeshLeaf) {
            search.add(next.child & ~kMeshLeaf);
            continue;
        }
        const MeshNode& node = nodes[next.child];
        HWY_ALIGN float bounds[kMeshNodeWidth];
        point_bounds(node, point, bounds);
        // The nearest child goes on top.
        const std::uint32_t base = height;
        for (std::uint32_t lane = 0; lane < node.count; ++lane) {
            if (search.is_beyond(bounds[lane])) continue;
            std::uint32_t place = height++;
            for (; place > base && stack[place - 1].bound < bounds[lane]; --place) stack[place] = stack[place - 1];
            stack[place] = {node.child[lane], bounds[lane]};
        }
    }
    search.finish();
}

// ---- Rays upward ----

// Separating axes of a ray and a box: the cross products of the ray with the box's axes, and the ray itself.
HWY_INLINE std::uint32_t lanes_above(const MeshNode& node, const UpwardRay& ray) {
    const D d;
    std::uint32_t apart = 0;
    for (std::size_t l = 0; l < node.count; l += hn::Lanes(d)) {
        V offset[3], along[3], up[3], reach[3], size = hn::Zero(d), below = hn::Zero(d);
        for (int i = 0; i < 3; ++i) {
            offset[i] = hn::Sub(hn::Load(d, node.center[i] + l), hn::Set(d, ray.origin[i]));
            reach[i] = hn::Load(d, node.half[i] + l);
            size = hn::Add(size, hn::Add(hn::Abs(offset[i]), reach[i]));
            below = hn::MulAdd(offset[i], hn::Set(d, ray.axes[2][i]), below);
        }
        const V error = hn::MulAdd(size, hn::Set(d, 0x1p-18f), hn::Set(d, ray.error));
        for (int k = 0; k < 3; ++k) {
            const V x = hn::Load(d, node.axes[k][0] + l), y = hn::Load(d, node.axes[k][1] + l),
                    z = hn::Load(d, node.axes[k][2] + l);
            along[k] = hn::MulAdd(x, offset[0], hn::MulAdd(y, offset[1], hn::Mul(z, offset[2])));
            up[k] = hn::MulAdd(x, hn::Set(d, ray.axes[2][0]),
                               hn::MulAdd(y, hn::Set(d, ray.axes[2][1]), hn::Mul(z, hn::Set(d, ray.axes[2][2]))));
            reach[k] = hn::Add(reach[k], error);
            below = hn::MulAdd(reach[k], hn::Abs(up[k]), below);
        }
        V gap = hn::Neg(below);
        for (int k = 0; k < 3; ++k) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            const V across = hn::Abs(hn::NegMulAdd(along[j], up[i], hn::Mul(along[i], up[j])));
            const V radius = hn::MulAdd(reach[i], hn::Abs(up[j]), hn::Mul(reach[j], hn::Abs(up[i])));
            gap = hn::Max(gap, hn::Sub(across, radius));
        }
        apart |= simd::mask_bits(d, hn::Gt(gap, error)) << l;
    }
    return ~apart & ((1u << node.count) - 1u);
}

struct LanesAbove {
    std::uint32_t crossed = 0, open = 0;  // surely crossed; perhaps
};

// Seen along the ray, its origin is on one side of all three edges of a triangle that is crossed, and on different
// sides of two edges of one that is passed by.
HWY_INLINE LanesAbove triangles_above(const MeshLeaf& leaf, const UpwardRay& ray) {
    const DT d;
    std::uint32_t crossed = 0, missed = 0;
    for (std::size_t l = 0; l < leaf.count; l += hn::Lanes(d)) {
        VT at[3][3], size = hn::Set(d, 1e-30f);
        for (int v = 0; v < 3; ++v) {
            VT offset[3];
            for (int i = 0; i < 3; ++i) {
                offset[i] = hn::Sub(hn::Load(d, leaf.vertex[v][i] + l), hn::Set(d, ray.origin[i]));
                size = hn::Add(size, hn::Abs(offset[i]));
            }
            for (int k = 0; k < 3; ++k)
                at[v][k] = hn::MulAdd(
                    offset[0], hn::Set(d, ray.axes[k][0]),
                    hn::MulAdd(offset[1], hn::Set(d, ray.axes[k][1]), hn::Mul(offset[2], hn::Set(d, ray.axes[k][2]))));
        }
        // Scaled to 1, so that products do not overflow. Each is off by less than 4 errors, and so is the sum of three
        // with heights below 1.
        const VT scale = hn::Div(hn::Set(d, 1.0f), size);
        const VT error = hn::MulAdd(scale, hn::Set(d, ray.error), hn::Set(d, 0x1p-20f));
        for (auto& corner : at)
            for (VT& coordinate : corner) coordinate = hn::Mul(coordinate, scale);
        VT side[3];
        for (int v = 0; v < 3; ++v) {
            const int w = v == 2 ? 0 : v + 1;
            side[v] = hn::NegMulAdd(at[v][1], at[w][0], hn::Mul(at[v][0], at[w][1]));
        }
        const VT margin = hn::Mul(error, hn::Set(d, 4.0f)), least = hn::Min(side[0], hn::Min(side[1], side[2])),
                 most = hn::Max(side[0], hn::Max(side[1], side[2])),
                 top = hn::Max(at[0][2], hn::Max(at[1][2], at[2][2]));
        const auto left = hn::Gt(least, margin), right = hn::Lt(most, hn::Neg(margin));
        // The sides are the weights of the corners' heights where the ray meets the plane.
        const VT height = hn::MulAdd(side[0], at[2][2], hn::MulAdd(side[1], at[0][2], hn::Mul(side[2], at[1][2])));
        const VT above = hn::IfThenElse(left, height, hn::Neg(height));
        const VT doubt = hn::Mul(margin, hn::Set(d, 4.0f));
        const auto passes = hn::And(hn::Gt(most, margin), hn::Lt(least, hn::Neg(margin)));
        missed |= simd::mask_bits(d, hn::Or(passes, hn::Lt(top, hn::Neg(error)))) << l;
        crossed |= simd::mask_bits(d, hn::And(hn::Or(left, right), hn::Gt(above, doubt))) << l;
    }
    const std::uint32_t used = (1u << leaf.count) - 1u;
    crossed &= used & ~missed;
    return {crossed, used & ~missed & ~crossed};
}

HWY_INLINE bool visit_leaf_above(const MeshLeaf& leaf, const UpwardRay& ray, RayVisitor visit) {
    const LanesAbove above = triangles_above(leaf, ray);
    for (std::uint32_t lanes = above.crossed | above.open; lanes != 0; lanes &= lanes - 1) {
        const auto lane = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes));
        if (visit(leaf, lane, (above.crossed >> lane & 1u) != 0)) return true;
    }
    return false;
}

bool VisitAbove(const MeshNode* nodes, std::span<const MeshLeaf> leaves, const UpwardRay& ray, RayVisitor visit) {
    if (leaves.size() <= kFewLeaves) {
        for (const MeshLeaf& leaf : leaves)
            if (visit_leaf_above(leaf, ray, visit)) return true;
        return false;
    }
    std::uint32_t stack[kMeshStackSize], height = 0;
    stack[height++] = 0;
    while (height > 0) {
        const std::uint32_t child = stack[--height];
        if (child & kMeshLeaf) {
            if (visit_leaf_above(leaves[child & ~kMeshLeaf], ray, visit)) return true;
            continue;
        }
        for (std::uint32_t mask = lanes_above(nodes[child], ray); mask != 0; mask &= mask - 1)
            stack[height++] = nodes[child].child[hwy::Num0BitsBelowLS1Bit_Nonzero32(mask)];
    }
    return false;
}

}  // namespace crofton::mesh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::mesh {

HWY_EXPORT(VisitNearestToPoint);
HWY_EXPORT(VisitAbove);

void visit_nearest_triangles(const MeshNode* nodes, std::span<const MeshLeaf> leaves, const NearPoint& point,
                             const double& squared, TriangleVisitor visit) {
    HWY_DYNAMIC_DISPATCH(VisitNearestToPoint)(nodes, leaves, point, squared, visit);
}

bool visit_triangles_above(const MeshNode* nodes, std::span<const MeshLeaf> leaves, const UpwardRay& ray,
                           RayVisitor visit) {
    return HWY_DYNAMIC_DISPATCH(VisitAbove)(nodes, leaves, ray, visit);
}

}  // namespace crofton::mesh
#endif
