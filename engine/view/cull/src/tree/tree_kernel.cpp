// SPDX-License-Identifier: MIT
#include "tree/tree_kernel.hpp"

#include <cstddef>
#include <cstdint>

// Also compile for AVX-512 VNNI (`vpdpwssd`).
#define HWY_WANT_AVX3_DL 1
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include "limits/limit_tests-inl.hpp"
#include "tree/tree_walk-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {
namespace {

void run_tree(const TreeKernelInput& input, const std::uint64_t* entries, std::size_t count, TreeKernelOutput& output) {
    Walk<NoLimits> walk(&input, output, {});
    walk.run(entries, count);
    output = walk.result();
}

void run_tree_of_candidates(const TreeKernelInput& input, const std::uint64_t* entries, std::size_t count,
                            TreeKernelOutput& output) {
    Walk<NoLimits, true> walk(&input, output, {});
    walk.run(entries, count);
    output = walk.result();
}

void run_moved_trees(const TreeKernelInput* inputs, const std::uint32_t* planes, std::size_t count,
                     TreeKernelOutput& output) {
    std::uint64_t entries[kMostMovedTrees];
    for (std::size_t t = 0; t < count; ++t)
        entries[t] = tree_entry(0, planes[t] | static_cast<std::uint32_t>(t) << kTreeMarkShift);
    Walk<NoLimits, false, true> walk(inputs, output, {});
    walk.run(entries, count);
    output = walk.result();
}

void run_limited_tree(const TreeKernelInput& input, const KernelLimits& limits, TreeKernelOutput& output) {
    Walk<LimitTester> walk(&input, output, LimitTester(limits, input.view->layer_mask));
    const std::uint64_t root = tree_entry(0, ((1u << input.view->plane_count) - 1) | kLimited);
    walk.run(&root, 1);
    output = walk.result();
}

// Replaces an entry by those of its children. Leaves, and subtrees inside the view, stay as they are.
std::size_t expand_tree(const TreeKernelInput& input, std::uint64_t entry, std::uint64_t* entries) {
    const auto child = static_cast<std::uint32_t>(entry >> 32);
    const auto planes = static_cast<std::uint32_t>(entry);
    if (child & boxtree::kLeafBit || planes & kWhole) {
        entries[0] = entry;
        return 1;
    }
    const boxtree::Node& node = input.nodes[child];
    TurnedPlanes turned(*input.view);
    const NodeTest test =
        test_node(*input.view, *input.view, turned.along(input.axes, node.axes, planes), node, planes);
    std::size_t count = 0;
    const std::uint32_t whole = seen(*input.view, node, test.alive & test.inside);
    for (std::uint32_t alive = test.alive; alive; alive &= alive - 1) {
        const auto lane = static_cast<unsigned>(hwy::Num0BitsBelowLS1Bit_Nonzero32(alive));
        entries[count++] = tree_entry(node.child[lane], whole >> lane & 1 ? kWhole : test.planes[lane]);
    }
    return count;
}

}  // namespace
}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::cull {

HWY_EXPORT(run_tree);
HWY_EXPORT(run_tree_of_candidates);
HWY_EXPORT(run_moved_trees);
HWY_EXPORT(run_limited_tree);
HWY_EXPORT(expand_tree);

std::size_t expand_tree_kernel(const TreeKernelInput& input, std::uint64_t entry, std::uint64_t* entries) {
    return HWY_DYNAMIC_DISPATCH(expand_tree)(input, entry, entries);
}

void run_tree_kernel(const TreeKernelInput& input, const std::uint64_t* entries, std::size_t count,
                     TreeKernelOutput& output) {
    if (input.leaves_with_candidates != nullptr)
        return HWY_DYNAMIC_DISPATCH(run_tree_of_candidates)(input, entries, count, output);
    HWY_DYNAMIC_DISPATCH(run_tree)(input, entries, count, output);
}

void run_moved_trees_kernel(const TreeKernelInput* inputs, const std::uint32_t* planes, std::size_t count,
                            TreeKernelOutput& output) {
    HWY_DYNAMIC_DISPATCH(run_moved_trees)(inputs, planes, count, output);
}

void run_limited_tree_kernel(const TreeKernelInput& input, const KernelLimits& limits, TreeKernelOutput& output) {
    HWY_DYNAMIC_DISPATCH(run_limited_tree)(input, limits, output);
}

}  // namespace crofton::cull
#endif
