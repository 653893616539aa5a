// SPDX-License-Identifier: MIT
// A ray through a mesh tree, compiled for each instruction set and chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ray_traversal.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include <hwy/highway.h>

#include "double_lanes-inl.hpp"
#include "ray_mesh.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::mesh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, mesh::kMeshNodeWidth>;
using V = hn::Vec<D>;

// Slabs of sixteen boxes, grown by the slop: entry distance of each lane that is met before `limit`.
HWY_INLINE std::uint32_t box_entries(const mesh::MeshNode& node, const RayQuery& q, float limit, float* entry) {
    const D d;
    std::uint32_t lanes = 0;
    for (std::size_t l = 0; l < mesh::kMeshNodeWidth; l += hn::Lanes(d)) {
        V offset[3], first = hn::Zero(d), last = hn::Set(d, limit);
        for (int i = 0; i < 3; ++i) offset[i] = hn::Sub(hn::Load(d, node.center[i] + l), hn::Set(d, q.start[i]));
        for (int k = 0; k < 3; ++k) {
            V along = hn::Zero(d), speed = hn::Zero(d);
            for (int i = 0; i < 3; ++i) {
                const V axis = hn::Load(d, node.axes[k][i] + l);
                along = hn::MulAdd(axis, offset[i], along);
                speed = hn::MulAdd(axis, hn::Set(d, q.unit[i]), speed);
            }
            const V half = hn::Add(hn::Load(d, node.half[k] + l), hn::Set(d, q.slop));
            // Parallel to the slab: a tiny speed keeps the bounds finite and on the right sides.
            const V least = hn::Set(d, 1e-18f);
            speed = hn::IfThenElse(hn::Lt(hn::Abs(speed), least), least, speed);
            const V inverse = hn::Div(hn::Set(d, 1.0f), speed);
            const V t0 = hn::Mul(hn::Sub(along, half), inverse), t1 = hn::Mul(hn::Add(along, half), inverse);
            first = hn::Max(first, hn::Min(t0, t1));
            last = hn::Min(last, hn::Max(t0, t1));
        }
        // 2^-20 covers the divisions.
        first = hn::Mul(first, hn::Set(d, 1.0f - 0x1p-20f));
        last = hn::Mul(last, hn::Set(d, 1.0f + 0x1p-20f));
        hn::Store(first, d, entry + l);
        std::uint8_t bytes[8] = {};
        hn::StoreMaskBits(d, hn::Le(first, last), bytes);
        lanes |= (static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8) << l;
    }
    return lanes & ((1u << node.count) - 1u);
}

// Where the line meets the planes of the triangles, kept between the nearest and the farthest vertex along it: a
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

// The line passes through a triangle iff its three determinants with the edges do not differ in sign. `open`: lanes
// where a sign is uncertain.
HWY_INLINE std::uint32_t triangle_hits(const mesh::MeshLeaf& leaf, const RayQuery& q, double* t, std::uint32_t& open) {
    const DD d;
    const hn::Rebind<float, DD> df;
    std::uint32_t hits = 0;
    for (std::size_t l = 0; l < mesh::kMeshLeafWidth; l += hn::Lanes(d)) {
        VD p[3][3], direction[3];
        for (int i = 0; i < 3; ++i) {
            direction[i] = hn::Set(d, q.direction[i]);
            for (int v = 0; v < 3; ++v)
                p[v][i] = hn::Sub(hn::PromoteTo(d, hn::Load(df, leaf.vertex[v][i] + l)), hn::Set(d, q.origin[i]));
        }
        const VD scale = hn::Mul(sum_abs(direction), hn::Set(d, kDeterminantError));
        const VD size[3] = {sum_abs(p[0]), sum_abs(p[1]), sum_abs(p[2])};
        MD positive = hn::Lt(hn::Zero(d), hn::Zero(d)), negative = positive, unknown = positive;
        for (int v = 0; v < 3; ++v) {
            const int w = (v + 1) % 3;
            VD n[3];
            cross(p[v], p[w], n);
            const VD value = dot(direction, n);
            const VD error = hn::MulAdd(hn::Mul(size[v], size[w]), scale, hn::Set(d, 1e-280));
            const MD up = hn::Gt(value, error), down = hn::Lt(value, hn::Neg(error));
            positive = hn::Or(positive, up);
            negative = hn::Or(negative, down);
            unknown = hn::Or(unknown, hn::Not(hn::Or(up, down)));
        }
        hn::Store(parameters(d, p, direction), d, t + l);
        const MD agree = hn::Not(hn::And(positive, negative));
        hits |= bits_of(d, hn::AndNot(unknown, agree), l);
        open |= bits_of(d, hn::And(unknown, agree), l);
    }
    return hits;
}

HWY_INLINE void trace_leaf(const RayQuery& q, std::uint32_t index, LineTest line_meets, RayAnswer& answer) {
    const mesh::MeshLeaf& leaf = q.leaves[index];
    HWY_ALIGN double t[mesh::kMeshLeafWidth];
    std::uint32_t open = 0;
    std::uint32_t lanes = triangle_hits(leaf, q, t, open);
    lanes = (lanes | open) & ((1u << leaf.count) - 1u);
    for (; lanes != 0; lanes &= lanes - 1) {
        const auto lane = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes));
        if (!(t[lane] >= 0.0 && t[lane] <= answer.t)) continue;
        if (answer.hit && t[lane] == answer.t && leaf.triangle[lane] > answer.triangle) continue;
        if ((open >> lane & 1u) && !line_meets(index, lane)) continue;
        answer = {t[lane], leaf.triangle[lane], true};
        if (q.any) return;
    }
}

RayAnswer Trace(const RayQuery& q, LineTest line_meets) {
    struct Step {
        std::uint32_t child;
        float entry;
    };
    Step stack[256];
    std::uint32_t height = 0;
    RayAnswer answer{q.max_t, 0, false};
    stack[height++] = {0, 0.0f};
    while (height > 0) {
        const Step step = stack[--height];
        const double reached = answer.t * static_cast<double>(q.length) * (1.0 + 1e-6);
        if (static_cast<double>(step.entry) > reached) continue;
        if (step.child & mesh::kMeshLeaf) {
            trace_leaf(q, step.child & ~mesh::kMeshLeaf, line_meets, answer);
            if (q.any && answer.hit) break;
            continue;
        }
        const mesh::MeshNode& node = q.nodes[step.child];
        HWY_ALIGN float entry[mesh::kMeshNodeWidth];
        const float limit = reached < 1e37 ? static_cast<float>(reached) * 1.000001f + q.slop : 1e37f;
        // The nearest child goes on top.
        const std::uint32_t base = height;
        for (std::uint32_t lanes = box_entries(node, q, limit, entry); lanes != 0; lanes &= lanes - 1) {
            const auto lane = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes));
            std::uint32_t place = height++;
            for (; place > base && stack[place - 1].entry < entry[lane]; --place) stack[place] = stack[place - 1];
            stack[place] = {node.child[lane], entry[lane]};
        }
    }
    return answer;
}

}  // namespace crofton::mesh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::mesh {

HWY_EXPORT(Trace);

RayAnswer trace(const RayQuery& query, LineTest line_meets) {
    return HWY_DYNAMIC_DISPATCH(Trace)(query, line_meets);
}

}  // namespace crofton::mesh
#endif
