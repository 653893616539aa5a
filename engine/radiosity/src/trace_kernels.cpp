// SPDX-License-Identifier: MIT
#include "trace_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trace_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <bit>

HWY_BEFORE_NAMESPACE();
namespace crofton::radiosity::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<float, kLanes>;
using V = hn::Vec<D>;

inline unsigned bits_of(D d, hn::Mask<D> mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, mask, bytes);
    return bytes[0] & ((1u << hn::Lanes(d)) - 1u);
}

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

// Which children the line passes between t_low and t_high, and where it enters each. Each of the three steps of a
// plane's parameter rounds by 2^-24; widening the interval by 2^-21 of its ends covers them.
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
        const V slack = hn::Mul(hn::Set(d, 0x1p-21f), hn::Max(hn::Abs(enter), hn::Abs(leave)));
        hn::Store(enter, d, entry + i);
        bits |= bits_of(d, hn::Le(enter, hn::Add(leave, slack))) << i;
    }
    return bits & ((1u << node.count) - 1u);
}

// Möller and Trumbore, both sides. `front`: the line runs against the normal.
HWY_INLINE unsigned triangles(D d, const TracerLeaf& leaf, const Spread& ray, float* t_out, unsigned* front) {
    unsigned bits = 0;
    const V zero = hn::Zero(d);
    *front = 0;
    for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
        V e1[3], e2[3], s[3], p[3], q[3];
        for (int k = 0; k < 3; ++k) {
            e1[k] = hn::Load(d, leaf.first[k] + i);
            e2[k] = hn::Load(d, leaf.second[k] + i);
            s[k] = hn::Sub(ray.point[k], hn::Load(d, leaf.corner[k] + i));
        }
        const auto cross = [](const V* a, const V* b, V* out) {
            out[0] = hn::Sub(hn::Mul(a[1], b[2]), hn::Mul(a[2], b[1]));
            out[1] = hn::Sub(hn::Mul(a[2], b[0]), hn::Mul(a[0], b[2]));
            out[2] = hn::Sub(hn::Mul(a[0], b[1]), hn::Mul(a[1], b[0]));
        };
        const auto dot = [](const V* a, const V* b) {
            return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2]));
        };
        cross(ray.direction, e2, p);
        const V determinant = dot(e1, p);
        const V scale = hn::Div(hn::Set(d, 1.0f), determinant);
        const V u = hn::Mul(dot(s, p), scale);
        cross(s, e1, q);
        const V v = hn::Mul(dot(ray.direction, q), scale);
        const V t = hn::Mul(dot(e2, q), scale);
        const auto inside = hn::And(hn::And(hn::Ge(u, zero), hn::Ge(v, zero)),
                                    hn::And(hn::Le(hn::Add(u, v), hn::Set(d, 1.0f)), hn::Ne(determinant, zero)));
        hn::Store(t, d, t_out + i);
        bits |= bits_of(d, inside) << i;
        *front |= bits_of(d, hn::Gt(determinant, zero)) << i;
    }
    return bits & ((1u << leaf.count) - 1u);
}

constexpr float kFar = 3e38f;

// Where two faces back to back coincide, rounding must not put the back one in front.
HWY_INLINE float sort_key(const FlatHit& hit, float tie) {
    return (hit.triangle & kFront) ? hit.t : hit.t + tie;
}

std::size_t trace_all(const TracerView& tree, const FlatRay* rays, std::size_t count, FlatHit* hits,
                      std::size_t capacity, std::uint32_t* ends) {
    const D d;
    std::uint32_t stack[kMaxDepth * kLanes];
    alignas(64) float values[kLanes];
    std::size_t used = 0;
    for (std::size_t r = 0; r < count; ++r) {
        const Spread ray(d, rays[r]);
        const std::size_t first = used;
        std::size_t top = 0;
        stack[top++] = 0;
        while (top > 0) {
            const std::uint32_t item = stack[--top];
            if (item & kLeaf) {
                const TracerLeaf& leaf = tree.leaves[item & ~kLeaf];
                unsigned front;
                unsigned bits = triangles(d, leaf, ray, values, &front);
                if (used + kLanes > capacity) return r;
                for (; bits != 0; bits &= bits - 1) {
                    const unsigned lane = static_cast<unsigned>(std::countr_zero(bits));
                    const FlatHit hit{values[lane], leaf.triangle[lane] | ((front >> lane & 1u) ? kFront : 0u)};
                    // Insertion keeps the few hits of one line sorted, ties by number.
                    const auto before = [&](const FlatHit& x, const FlatHit& y) {
                        const float kx = sort_key(x, tree.tie), ky = sort_key(y, tree.tie);
                        return kx != ky ? kx < ky : x.triangle < y.triangle;
                    };
                    std::size_t at = used++;
                    for (; at > first && before(hit, hits[at - 1]); --at) hits[at] = hits[at - 1];
                    hits[at] = hit;
                }
                continue;
            }
            const mesh::BoxNode& node = tree.nodes[item];
            for (unsigned bits = children(d, node, ray, -kFar, kFar, values); bits != 0; bits &= bits - 1)
                stack[top++] = node.child[static_cast<unsigned>(std::countr_zero(bits))];
        }
        ends[r] = static_cast<std::uint32_t>(used);
    }
    return count;
}

void trace_first(const TracerView& tree, const FlatRay* rays, std::size_t count, FlatHit* hits) {
    const D d;
    struct Entry {
        std::uint32_t item;
        float enter;
    };
    Entry stack[kMaxDepth * kLanes];
    alignas(64) float values[kLanes];
    for (std::size_t r = 0; r < count; ++r) {
        const Spread ray(d, rays[r]);
        FlatHit best{kFar, kMiss};
        float best_key = kFar;
        std::size_t top = 0;
        stack[top++] = {0, 0.0f};
        while (top > 0) {
            const Entry entry = stack[--top];
            if (entry.enter > best_key) continue;
            if (entry.item & kLeaf) {
                const TracerLeaf& leaf = tree.leaves[entry.item & ~kLeaf];
                unsigned front;
                for (unsigned bits = triangles(d, leaf, ray, values, &front); bits != 0; bits &= bits - 1) {
                    const unsigned lane = static_cast<unsigned>(std::countr_zero(bits));
                    if (!(values[lane] > tree.tie) || leaf.triangle[lane] == rays[r].skip) continue;
                    const FlatHit hit{values[lane], leaf.triangle[lane] | ((front >> lane & 1u) ? kFront : 0u)};
                    const float key = sort_key(hit, tree.tie);
                    if (key < best_key || (key == best_key && hit.triangle < best.triangle)) {
                        best = hit;
                        best_key = key;
                    }
                }
                continue;
            }
            const mesh::BoxNode& node = tree.nodes[entry.item];
            const std::size_t base = top;
            for (unsigned bits = children(d, node, ray, 0.0f, best_key, values); bits != 0; bits &= bits - 1) {
                const unsigned lane = static_cast<unsigned>(std::countr_zero(bits));
                const Entry child{node.child[lane], values[lane]};
                std::size_t at = top++;  // the nearest on top
                for (; at > base && stack[at - 1].enter < child.enter; --at) stack[at] = stack[at - 1];
                stack[at] = child;
            }
        }
        hits[r] = best;
    }
}

}  // namespace crofton::radiosity::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::radiosity::detail {

HWY_EXPORT(trace_all);
HWY_EXPORT(trace_first);

std::size_t trace_all(const TracerView& tree, const FlatRay* rays, std::size_t count, FlatHit* hits,
                      std::size_t capacity, std::uint32_t* ends) {
    return HWY_DYNAMIC_DISPATCH(trace_all)(tree, rays, count, hits, capacity, ends);
}
void trace_first(const TracerView& tree, const FlatRay* rays, std::size_t count, FlatHit* hits) {
    HWY_DYNAMIC_DISPATCH(trace_first)(tree, rays, count, hits);
}

}  // namespace crofton::radiosity::detail
#endif
