// SPDX-License-Identifier: MIT
// One view against a box tree, in vectors: the filter's verdicts, and the list of undecided items.
#pragma once
#include <crofton/boxtree/layout.hpp>

#include "kernel_view.hpp"
#include "limits/kernel_limits.hpp"

namespace crofton::cull {

struct TreeKernelInput {
    const boxtree::Node* nodes;
    const boxtree::Leaf* leaves;
    const boxtree::LeafRange* ranges;
    const std::uint8_t* leaf_counts;
    const boxtree::ItemId* slot_items;
    const boxtree::Axes* axes;
    const KernelView* view;
    bool exact;  // boxes that straddle two planes or more may yet be outside: undecided
    // Where they are given, the slots of a leaf and the children of a node that are asked for. The others are left out
    // in silence. For run_tree_kernel without `runs`.
    const std::uint16_t* leaves_with_candidates = nullptr;
    const std::uint16_t* nodes_with_candidates = nullptr;
    // For run_moved_trees_kernel: added to the items' ids, and where the view is in the tree's coordinates.
    std::uint32_t first_id = 0;
    const ViewPlace* place = nullptr;
};

// Slots [first, first + count), all of whose items are inside.
struct SlotRun {
    std::uint32_t first, count;
};

// Capacities: each list has room for all items and 16 more, `runs` for all leaves. `work` has room for kWorkLists lists
// of `work_size`. That is the number of nodes and leaves that the entries name, and of those below them, and 16 more.
// The `whole_count` items that a node above them accepted come first in `inside`. Where `runs` is given they are named
// there instead, as runs of the tree's slots.
struct TreeKernelOutput {
    boxtree::ItemId* inside;
    boxtree::ItemId* straddling;
    std::uint32_t* undecided;  // slots
    std::uint32_t* work;
    std::size_t work_size;
    SlotRun* runs;
    std::size_t run_count;
    std::size_t inside_count, straddling_count, undecided_count, whole_count;
    std::uint64_t nodes_tested, boxes_tested, accepted_whole;
    std::uint64_t false_positives;             // outside, found by a separating axis
    std::uint32_t* undecided_trees = nullptr;  // for run_moved_trees_kernel: which tree's slot it is
};

inline constexpr std::size_t kWorkLists = 9, kMovedWorkLists = 11;
// So many entries are handled together; the answer's order depends on which.
inline constexpr std::size_t kTreeGroup = 8;

// An entry names a child and the planes that are still to be tested for what is below: child << 32 | planes.
[[nodiscard]] constexpr std::uint64_t tree_entry(std::uint32_t child, std::uint32_t planes) {
    return std::uint64_t{child} << 32 | planes;
}

// The children of `entry` that are not certainly outside, in the order of their lanes, as entries; returns how many (≤
// 16).
std::size_t expand_tree_kernel(const TreeKernelInput& input, std::uint64_t entry, std::uint64_t* entries);

// Handles the children that `count` ≤ 256 entries name, and all below them.
void run_tree_kernel(const TreeKernelInput& input, const std::uint64_t* entries, std::size_t count,
                     TreeKernelOutput& output);

// Handles several trees at once, each below its root. inputs[i] is asked for with the planes that planes[i] names.
// All have the first one's view. Requires 1 ≤ count ≤ kMostMovedTrees. `work` has
// kMovedWorkLists lists for the nodes and leaves of all of them; `runs` is not used.
inline constexpr std::size_t kMostMovedTrees = 64;
void run_moved_trees_kernel(const TreeKernelInput* inputs, const std::uint32_t* planes, std::size_t count,
                            TreeKernelOutput& output);

// Above a tree's planes in its entries: which tree it is.
inline constexpr std::uint32_t kTreeMarkShift = 16;
[[nodiscard]] constexpr std::uint32_t tree_mark_of(std::uint32_t planes) {
    return planes >> kTreeMarkShift;
}

// From the root, where draw limits hold: `undecided` are also the slots whose items may be beyond one. `runs` is not
// used.
void run_limited_tree_kernel(const TreeKernelInput& input, const KernelLimits& limits, TreeKernelOutput& output);

}  // namespace crofton::cull
