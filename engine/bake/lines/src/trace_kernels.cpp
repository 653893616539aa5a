// SPDX-License-Identifier: MIT
#include "trace_kernels.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <bit>

#include "line_tests-inl.hpp"
#include "stream-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::lines::detail::HWY_NAMESPACE {

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

}  // namespace crofton::lines::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::lines::detail {

HWY_EXPORT(trace_first);
HWY_EXPORT(flatten);
HWY_EXPORT(trace_stream);

void flatten(const double* lines, std::size_t count, const double* origin, StreamLine* flat) {
    HWY_DYNAMIC_DISPATCH(flatten)(lines, count, origin, flat);
}
StreamEnd trace_stream(const TracerView& tree, const StreamLine* lines, std::size_t count, std::uint16_t* lists,
                       std::size_t list_capacity, StreamCrossings& found) {
    return HWY_DYNAMIC_DISPATCH(trace_stream)(tree, lines, count, lists, list_capacity, found);
}

void trace_first(const TracerView& tree, const FlatRay* rays, std::size_t count, FlatHit* hits) {
    HWY_DYNAMIC_DISPATCH(trace_first)(tree, rays, count, hits);
}

}  // namespace crofton::lines::detail
#endif
