// SPDX-License-Identifier: MIT
#include "trace_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trace_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <bit>

#include "beam-inl.hpp"
#include "line_tests-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::radiosity::detail::HWY_NAMESPACE {

std::size_t trace_all(const TracerView& tree, const FlatRay* rays, std::size_t count, FlatHit* hits,
                      std::size_t capacity, std::uint32_t* ends) {
    const D d;
    std::uint32_t stack[kMaxDepth * kLanes];
    alignas(64) float values[kLanes];
    std::size_t used = 0;
    std::size_t next_beam = 0;
    for (std::size_t r = 0; r < count; ++r) {
        if (r == next_beam && r + kBeamLines <= count) {
            next_beam += kBeamLines;
            const BeamEnd end = trace_beam(tree, rays + r, hits, capacity, used, ends + r);
            if (end == BeamEnd::full) return r;
            if (end == BeamEnd::done) {
                r = next_beam - 1;
                continue;
            }
        }
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
                    put_in_order(hits, first, used, hit, tree.tie);
                    ++used;
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
