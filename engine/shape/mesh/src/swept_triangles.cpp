// SPDX-License-Identifier: MIT
// Tests a moving box against a mesh tree, compiled for each instruction set and chosen at run time.
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include <hwy/highway.h>
#include <crofton/mesh/swept_triangles.hpp>

#include "mesh_kernels-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::mesh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using DT = hn::CappedTag<float, kMeshLeafWidth>;
using VT = hn::Vec<DT>;

// Where on its way the shape may overlap something, along all axes so far. Along an axis of any length, on which the
// two are `low` to `high` apart at 0, grown by the shape's extent and all errors, it is where low <= s · speed <= high.
template <class Tag>
struct Stretch {
    using Vec = hn::Vec<Tag>;
    Vec first, last;

    // `per_speed`: finite, of a speed that is not 0.
    HWY_INLINE void cut(Vec low, Vec high, Vec per_speed) {
        const Vec a = hn::Mul(low, per_speed), b = hn::Mul(high, per_speed);
        first = hn::Max(first, hn::Min(a, b));
        last = hn::Min(last, hn::Max(a, b));
    }
    // Where nothing moves: all of the way, or none of it.
    HWY_INLINE void cut_still(Vec low, Vec high) {
        first = hn::Max(first, low);
        last = hn::Min(last, high);
    }
};

// Ways between nearest points that are tried, each from where the one before leads.
constexpr int kRounds = 2;

// A speed so small changes nothing within the shape's errors.
template <class Tag, class Vec>
HWY_INLINE Vec per_speed_of(Tag d, Vec speed, Vec least) {
    return hn::Div(hn::Set(d, 1.0f), hn::IfThenElse(hn::Lt(hn::Abs(speed), least), least, speed));
}

// kStill: of a shape that does not move. It is asked at 0 alone.
template <bool kStill>
class Sweep {
  public:
    explicit Sweep(const SweptBox& swept)
        : box_(box_of(swept.box.core)), radius_(swept.box.radius), error_(swept.box.error) {
        longest_ = HWY_MAX(swept.from < 0.0f ? -swept.from : swept.from, swept.to < 0.0f ? -swept.to : swept.to);
        from_ = swept.from;
        for (int k = 0; k < 3; ++k) {
            speed_[k] = along(box_.axes[k], swept.way);
            const float size = speed_[k] < 0.0f ? -speed_[k] : speed_[k];
            per_speed_[k] = 1.0f / (size < 1e-12f ? 1e-12f : speed_[k]);
        }
        rounded_ = radius_ > 0.0f;
        is_segment_ = rounded_ && box_.half[0] == 0.0f && box_.half[2] == 0.0f;
        is_ball_ = is_segment_ && box_.half[1] == 0.0f;
    }

    // The lanes whose boxes may be met up to `limit`, and where at the earliest: along the face normals of both, and of
    // a rounded shape along the way between about the nearest points.
    HWY_INLINE std::uint32_t nodes_met(const MeshNode& node, float limit, float* entry) const {
        if (kStill && is_segment_) return nodes_near_segment(node);
        const D d;
        std::uint32_t lanes = 0;
        for (std::size_t l = 0; l < kMeshNodeWidth; l += hn::Lanes(d)) {
            const Lanes s = prepare(d, node, l, box_, error_);
            Stretch<D> met{hn::Set(d, from_), hn::Set(d, limit)};
            for (int i = 0; i < 3; ++i) {
                const V reach =
                    hn::MulAdd(s.half[0], s.magnitude[i][0],
                               hn::MulAdd(s.half[1], s.magnitude[i][1],
                                          hn::MulAdd(s.half[2], s.magnitude[i][2],
                                                     hn::Add(hn::Set(d, box_.half[i] + radius_), s.error))));
                if constexpr (kStill)
                    met.cut_still(hn::Sub(s.t[i], reach), hn::Add(s.t[i], reach));
                else
                    met.cut(hn::Sub(s.t[i], reach), hn::Add(s.t[i], reach), hn::Set(d, per_speed_[i]));
            }
            for (int j = 0; j < 3; ++j) {
                V reach = hn::Add(s.half[j], hn::Add(s.error, hn::Set(d, radius_))), at = hn::Zero(d),
                  speed = hn::Zero(d);
                for (int i = 0; i < 3; ++i) {
                    reach = hn::MulAdd(hn::Set(d, box_.half[i]), s.magnitude[i][j], reach);
                    at = hn::MulAdd(s.t[i], s.r[i][j], at);
                    speed = hn::MulAdd(hn::Set(d, speed_[i]), s.r[i][j], speed);
                }
                if constexpr (kStill)
                    met.cut_still(hn::Sub(at, reach), hn::Add(at, reach));
                else
                    met.cut(hn::Sub(at, reach), hn::Add(at, reach), per_speed_of(d, speed, hn::Set(d, 1e-12f)));
            }
            if constexpr (!kStill)
                if (rounded_ && !hn::AllTrue(d, hn::Gt(met.first, met.last))) cut_from_box(d, s, met);
            lanes |= finish(d, met, entry + l) << l;
        }
        return lanes & ((1u << node.count) - 1u);
    }

    // The same of a leaf's triangles: along the normals of both, the edges of one across those of the other, and of a
    // rounded shape the normals of the triangle's edges in its plane. Points are taken in the box's frame. Any
    // direction parts what it parts, so that an axis may be rounded as it will: its products with the three corners are
    // off by less than 2^-20 of the corners' distance from the box and of its own length, which `error` holds.
    HWY_INLINE std::uint32_t triangles_met(const MeshLeaf& leaf, float limit, float* entry) const {
        const DT d;
        std::uint32_t lanes = 0;
        for (std::size_t l = 0; l < kMeshLeafWidth; l += hn::Lanes(d)) {
            VT p[3][3];
            for (int v = 0; v < 3; ++v) {
                VT offset[3];
                for (int i = 0; i < 3; ++i)
                    offset[i] = hn::Sub(hn::Load(d, leaf.vertex[v][i] + l), hn::Set(d, box_.center[i]));
                for (int k = 0; k < 3; ++k)
                    p[v][k] = hn::MulAdd(offset[0], hn::Set(d, box_.axes[k][0]),
                                         hn::MulAdd(offset[1], hn::Set(d, box_.axes[k][1]),
                                                    hn::Mul(offset[2], hn::Set(d, box_.axes[k][2]))));
            }
            Stretch<DT> met{hn::Set(d, from_), hn::Set(d, limit)};
            for (int k = 0; k < 3; ++k) {
                const VT reach = hn::Set(d, box_.half[k] + radius_ + error_);
                const VT low = hn::Min(p[0][k], hn::Min(p[1][k], p[2][k])),
                         high = hn::Max(p[0][k], hn::Max(p[1][k], p[2][k]));
                if constexpr (kStill)
                    met.cut_still(hn::Sub(low, reach), hn::Add(high, reach));
                else
                    met.cut(hn::Sub(low, reach), hn::Add(high, reach), hn::Set(d, per_speed_[k]));
            }
            if (kStill && hn::AllTrue(d, hn::Gt(met.first, met.last))) continue;
            VT edge[3][3], normal[3];
            for (int e = 0; e < 3; ++e)
                for (int k = 0; k < 3; ++k) edge[e][k] = hn::Sub(p[e == 2 ? 0 : e + 1][k], p[e][k]);
            cross(edge[0], edge[1], normal);
            const bool by_nearest = kStill && is_ball_;  // the way to the nearest point tells all
            if (!by_nearest) cut_along(d, p, normal, met);
            if (!by_nearest && !hn::AllTrue(d, hn::Gt(met.first, met.last))) {
                for (int e = 0; e < 3; ++e) {
                    for (int k = 0; k < 3; ++k) {
                        if (!(box_.half[k] > 0.0f)) continue;
                        VT axis[3];  // the edge across the box's axis k
                        axis[k] = hn::Zero(d);
                        axis[(k + 1) % 3] = edge[e][(k + 2) % 3];
                        axis[(k + 2) % 3] = hn::Neg(edge[e][(k + 1) % 3]);
                        cut_along(d, p, axis, met);
                    }
                    if (!rounded_) continue;
                    VT outward[3];
                    cross(edge[e], normal, outward);
                    cut_along(d, p, outward, met);
                }
            }
            if (rounded_ && !hn::AllTrue(d, hn::Gt(met.first, met.last)))
                for (int round = 0; round < (kStill ? 1 : kRounds); ++round)
                    cut_between_nearest(d, p, edge, normal, met);
            lanes |= finish(d, met, entry + l) << l;
        }
        return lanes & ((1u << leaf.count) - 1u);
    }

  private:
    // The lanes whose boxes may be near a capsule or ball. Seen from a box's own axes, the distance is no less than the
    // root of the gaps' squares. Axes A are orthonormal to 1.5e-6, so that the gaps are off by 4.5e-6 of the distance
    // and of the box's half extents, of which the root of their squares counts; their rounding is below 2^-20 of the
    // offset, which `error_` holds four times.
    HWY_INLINE std::uint32_t nodes_near_segment(const MeshNode& node) const {
        const D d;
        std::uint32_t lanes = 0;
        const V near = hn::Set(d, (radius_ + error_) * (1.0f + 0x1p-16f) + 1e-15f), length = hn::Set(d, box_.half[1]);
        for (std::size_t l = 0; l < kMeshNodeWidth; l += hn::Lanes(d)) {
            V offset[3], squared = hn::Zero(d), sum = hn::Zero(d);
            for (int i = 0; i < 3; ++i)
                offset[i] = hn::Sub(hn::Load(d, node.center[i] + l), hn::Set(d, box_.center[i]));
            for (int k = 0; k < 3; ++k) {
                const V x = hn::Load(d, node.axes[k][0] + l), y = hn::Load(d, node.axes[k][1] + l),
                        z = hn::Load(d, node.axes[k][2] + l), half = hn::Load(d, node.half[k] + l);
                const V at = hn::MulAdd(x, offset[0], hn::MulAdd(y, offset[1], hn::Mul(z, offset[2])));
                V reach = half;
                if (!is_ball_) {
                    const V turned =
                        hn::MulAdd(x, hn::Set(d, box_.axes[1][0]),
                                   hn::MulAdd(y, hn::Set(d, box_.axes[1][1]), hn::Mul(z, hn::Set(d, box_.axes[1][2]))));
                    reach = hn::MulAdd(length, hn::Abs(turned), reach);
                }
                const V gap = hn::Max(hn::Sub(hn::Abs(at), reach), hn::Zero(d));
                squared = hn::MulAdd(gap, gap, squared);
                sum = hn::Add(sum, half);
            }
            const V limit = hn::MulAdd(sum, hn::Set(d, 2.0f * kBoxError), near);
            lanes |= simd::mask_bits(d, hn::Le(squared, hn::Mul(limit, limit))) << l;
        }
        return lanes & ((1u << node.count) - 1u);
    }

    static HWY_INLINE void cross(const VT* a, const VT* b, VT* out) {
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            out[i] = hn::NegMulAdd(a[k], b[j], hn::Mul(a[j], b[k]));
        }
    }

    static HWY_INLINE VT dot(const VT* a, const VT* b) {
        return hn::MulAdd(a[0], b[0], hn::MulAdd(a[1], b[1], hn::Mul(a[2], b[2])));
    }
    static HWY_INLINE VT clamped(DT d, VT x) { return hn::Min(hn::Max(x, hn::Zero(d)), hn::Set(d, 1.0f)); }

    // About the point of each triangle that is nearest to x.
    HWY_INLINE void nearest_on(DT d, const VT (&p)[3][3], const VT (&edge)[3][3], const VT* normal, const VT* x,
                               VT* nearest) const {
        const VT tiny = hn::Set(d, 1e-36f);
        VT least = hn::Set(d, 3e38f), offset[3], side[3];
        auto within = hn::Eq(least, least);
        for (int e = 0; e < 3; ++e) {
            for (int k = 0; k < 3; ++k) offset[k] = hn::Sub(x[k], p[e][k]);
            cross(edge[e], offset, side);
            within = hn::And(within, hn::Ge(dot(side, normal), hn::Zero(d)));
            const VT at = clamped(d, hn::Div(dot(offset, edge[e]), hn::Add(dot(edge[e], edge[e]), tiny)));
            VT point[3], way[3];
            for (int k = 0; k < 3; ++k) {
                point[k] = hn::MulAdd(at, edge[e][k], p[e][k]);
                way[k] = hn::Sub(x[k], point[k]);
            }
            const VT squared = dot(way, way);
            const auto nearer = hn::Lt(squared, least);
            least = hn::IfThenElse(nearer, squared, least);
            for (int k = 0; k < 3; ++k) nearest[k] = e == 0 ? point[k] : hn::IfThenElse(nearer, point[k], nearest[k]);
        }
        // Within the face: below x.
        const VT height = hn::Div(dot(offset, normal), hn::Add(dot(normal, normal), tiny));
        for (int k = 0; k < 3; ++k)
            nearest[k] = hn::IfThenElse(within, hn::NegMulAdd(height, normal[k], x[k]), nearest[k]);
    }

    // Along the way between about the nearest points of the triangle and of the core, where that is at met.first.
    HWY_INLINE void cut_between_nearest(DT d, const VT (&p)[3][3], const VT (&edge)[3][3], const VT* normal,
                                        Stretch<DT>& met) const {
        VT center[3], x[3], nearest[3];
        for (int k = 0; k < 3; ++k) x[k] = center[k] = hn::Mul(met.first, hn::Set(d, speed_[k]));
        nearest_on(d, p, edge, normal, x, nearest);
        if (box_.half[0] + box_.half[1] + box_.half[2] > 0.0f) {
            for (int k = 0; k < 3; ++k) {
                const VT half = hn::Set(d, box_.half[k]), offset = hn::Sub(nearest[k], center[k]);
                x[k] = hn::Add(center[k], hn::Min(hn::Max(offset, hn::Neg(half)), half));
            }
            nearest_on(d, p, edge, normal, x, nearest);
        }
        VT axis[3];
        for (int k = 0; k < 3; ++k) axis[k] = hn::Sub(x[k], nearest[k]);
        cut_along(d, p, axis, met);
    }

    // The way to x from the nearest point of a node's box, whose center is at 0.
    static HWY_INLINE void way_from_box(const Lanes& s, const V* x, V* way) {
        V out[3];
        for (int j = 0; j < 3; ++j) {
            const V at = hn::MulAdd(x[0], s.r[0][j], hn::MulAdd(x[1], s.r[1][j], hn::Mul(x[2], s.r[2][j])));
            out[j] = hn::Sub(at, hn::Min(hn::Max(at, hn::Neg(s.half[j])), s.half[j]));
        }
        for (int i = 0; i < 3; ++i)
            way[i] = hn::MulAdd(out[0], s.r[i][0], hn::MulAdd(out[1], s.r[i][1], hn::Mul(out[2], s.r[i][2])));
    }

    // Along the way between about the nearest points of a node's box and of the core, where that is at met.first.
    HWY_INLINE void cut_from_box(D d, const Lanes& s, Stretch<D>& met) const {
        V x[3], axis[3], at = hn::Zero(d), reach = hn::Zero(d);
        for (int k = 0; k < 3; ++k) x[k] = hn::MulSub(met.first, hn::Set(d, speed_[k]), s.t[k]);
        way_from_box(s, x, axis);
        if (!is_ball_) {
            for (int k = 0; k < 3; ++k) {
                const V half = hn::Set(d, box_.half[k]);
                x[k] = hn::Sub(x[k], hn::Min(hn::Max(axis[k], hn::Neg(half)), half));
            }
            way_from_box(s, x, axis);
        }
        for (int k = 0; k < 3; ++k) {
            const V turned =
                hn::MulAdd(axis[0], s.r[0][k], hn::MulAdd(axis[1], s.r[1][k], hn::Mul(axis[2], s.r[2][k])));
            at = hn::MulAdd(axis[k], s.t[k], at);
            reach = hn::MulAdd(s.half[k], hn::Abs(turned), reach);
        }
        cut_along(d, hn::Sub(at, reach), hn::Add(at, reach), axis, s.error, met);
    }

    HWY_INLINE void cut_along(DT d, const VT (&p)[3][3], const VT* axis, Stretch<DT>& met) const {
        VT low, high;
        for (int v = 0; v < 3; ++v) {
            const VT at = hn::MulAdd(axis[0], p[v][0], hn::MulAdd(axis[1], p[v][1], hn::Mul(axis[2], p[v][2])));
            low = v == 0 ? at : hn::Min(low, at);
            high = v == 0 ? at : hn::Max(high, at);
        }
        cut_along(d, low, high, axis, hn::Set(d, error_), met);
    }

    // Of what reaches from `low` to `high` along the axis. An axis that is too short or too long for its products to be
    // floats parts nothing.
    template <class Tag, class Vec>
    HWY_INLINE void cut_along(Tag d, Vec low, Vec high, const Vec* axis, Vec error, Stretch<Tag>& met) const {
        Vec length = hn::Zero(d), squared = hn::Zero(d), reach = hn::Zero(d), speed = hn::Zero(d);
        for (int k = 0; k < 3; ++k) {
            const Vec size = hn::Abs(axis[k]);
            length = hn::Add(length, size);
            squared = hn::MulAdd(size, size, squared);
            reach = hn::MulAdd(size, hn::Set(d, box_.half[k]), reach);
            speed = hn::MulAdd(axis[k], hn::Set(d, speed_[k]), speed);
        }
        reach = hn::MulAdd(length, error, reach);
        if (rounded_) {
            const Vec root = hn::Mul(hn::Sqrt(squared), hn::Set(d, 1.0f + 0x1p-20f));
            const Vec euclidean = hn::IfThenElse(hn::Gt(squared, hn::Set(d, 1e-30f)), root, length);
            reach = hn::MulAdd(euclidean, hn::Set(d, radius_), reach);
        }
        const Vec far = hn::Set(d, 1e37f);
        const auto fit = hn::And(hn::Gt(length, hn::Set(d, 1e-24f)), hn::Lt(length, hn::Set(d, 1e18f)));
        low = hn::IfThenElse(fit, hn::Sub(low, reach), hn::Neg(far));
        high = hn::IfThenElse(fit, hn::Add(high, reach), far);
        if constexpr (kStill) return met.cut_still(low, high);
        const Vec least = hn::MulAdd(length, hn::Set(d, 1e-12f), hn::Set(d, 1e-36f));
        met.cut(low, high, hn::IfThenElse(fit, per_speed_of(d, speed, least), hn::Set(d, 1.0f)));
    }

    // Quotients of the way are off by 2^-21 of its length.
    template <class Tag>
    HWY_INLINE std::uint32_t finish(Tag d, const Stretch<Tag>& met, float* entry) const {
        const auto slack = hn::Set(d, longest_ * 0x1p-19f), first = hn::Sub(met.first, slack);
        hn::Store(first, d, entry);
        return simd::mask_bits(d, hn::Le(first, met.last));
    }

    const QueryBox box_;
    const float radius_, error_;
    float longest_, from_, speed_[3], per_speed_[3];
    bool rounded_, is_segment_, is_ball_;  // a core along the box's axis y, or a point
};

struct WaitingNode {
    std::uint32_t child;
    float entry;
};
struct WaitingTriangle {
    std::uint32_t leaf, lane;
    float entry;
};

void VisitSwept(const MeshNode* nodes, const MeshLeaf* leaves, const SweptBox& swept, const float& limit,
                TriangleVisitor visit) {
    constexpr std::uint32_t kMost = 64;
    const Sweep<false> sweep(swept);
    WaitingNode stack[kMeshStackSize];
    WaitingTriangle triangles[kMost];  // the first one last
    std::uint32_t height = 0, count = 0;
    stack[height++] = {0, swept.from};
    // Triangles wait until no node on top of the stack comes before them.
    while (height > 0 || count > 0) {
        while (height > 0 && stack[height - 1].entry > limit) --height;
        const bool full = count + kMeshLeafWidth > kMost;
        if (count > 0 && (full || height == 0 || triangles[count - 1].entry <= stack[height - 1].entry)) {
            const WaitingTriangle next = triangles[--count];
            if (next.entry <= limit && visit(leaves[next.leaf], next.lane)) return;
            continue;
        }
        if (height == 0) continue;
        const std::uint32_t child = stack[--height].child;
        HWY_ALIGN float entry[kMeshNodeWidth];
        if (child & kMeshLeaf) {
            const std::uint32_t leaf = child & ~kMeshLeaf;
            for (std::uint32_t lanes = sweep.triangles_met(leaves[leaf], limit, entry); lanes != 0;
                 lanes &= lanes - 1) {
                const auto lane = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes));
                std::uint32_t place = count++;
                for (; place > 0 && triangles[place - 1].entry <= entry[lane]; --place)
                    triangles[place] = triangles[place - 1];
                triangles[place] = {leaf, lane, entry[lane]};
            }
            continue;
        }
        const MeshNode& node = nodes[child];
        const std::uint32_t base = height;
        for (std::uint32_t lanes = sweep.nodes_met(node, limit, entry); lanes != 0; lanes &= lanes - 1) {
            const auto lane = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes));
            std::uint32_t place = height++;
            for (; place > base && stack[place - 1].entry < entry[lane]; --place) stack[place] = stack[place - 1];
            stack[place] = {node.child[lane], entry[lane]};
        }
    }
}

void VisitNear(const MeshNode* nodes, const MeshLeaf* leaves, const SweptBox& still, TriangleVisitor visit) {
    const Sweep<true> sweep(still);
    std::uint32_t stack[kMeshStackSize], height = 0;
    stack[height++] = 0;
    while (height > 0) {
        const std::uint32_t child = stack[--height];
        HWY_ALIGN float entry[kMeshNodeWidth];
        const bool is_leaf = (child & kMeshLeaf) != 0;
        const std::uint32_t leaf = child & ~kMeshLeaf;
        std::uint32_t lanes =
            is_leaf ? sweep.triangles_met(leaves[leaf], 0.0f, entry) : sweep.nodes_met(nodes[child], 0.0f, entry);
        for (; lanes != 0; lanes &= lanes - 1) {
            const auto lane = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes));
            if (!is_leaf)
                stack[height++] = nodes[child].child[lane];
            else if (visit(leaves[leaf], lane))
                return;
        }
    }
}

}  // namespace crofton::mesh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::mesh {

HWY_EXPORT(VisitSwept);
HWY_EXPORT(VisitNear);

void visit_swept_triangles(const MeshNode* nodes, const MeshLeaf* leaves, const SweptBox& swept, const float& limit,
                           TriangleVisitor visit) {
    HWY_DYNAMIC_DISPATCH(VisitSwept)(nodes, leaves, swept, limit, visit);
}

void visit_triangles_near(const MeshNode* nodes, const MeshLeaf* leaves, const RoundedBox& box, TriangleVisitor visit) {
    const SweptBox still{box, {0.0f, 0.0f, 0.0f}, 0.0f, 0.0f};
    HWY_DYNAMIC_DISPATCH(VisitNear)(nodes, leaves, still, visit);
}

}  // namespace crofton::mesh
#endif
