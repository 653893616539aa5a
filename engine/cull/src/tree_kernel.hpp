// One view against a box tree, in vectors: what a filter can decide, and the list of what it cannot.
#pragma once
#include <crofton/tree/layout.hpp>

#include "kernel_view.hpp"

namespace crofton::cull {

struct TreeKernelInput {
    const tree::Node* nodes;
    const tree::Leaf* leaves;
    const tree::LeafRange* ranges;
    const std::uint8_t* leaf_counts;
    const tree::ItemId* slot_items;
    const KernelView* view;
    bool exact;  // boxes that straddle two planes or more may yet be outside: undecided
};

// Slots [first, first + count), all of whose items are inside.
struct SlotRun {
    std::uint32_t first, count;
};

// The arrays have room for all items (the last three: for all leaves) and 16 more; `stack` for 16 entries a level. The
// items that a node above them settles, `whole_count` of them, come first in `inside`, or where there are `runs` stay
// in the tree's slots and are named there.
struct TreeKernelOutput {
    tree::ItemId* inside;
    tree::ItemId* straddling;
    std::uint32_t* undecided;    // slots
    std::uint64_t* stack;        // child << 32 | planes still to test
    std::uint32_t* open_leaves;  // those that straddle the view, and the planes that they straddle
    std::uint32_t* open_planes;
    SlotRun* runs;
    std::size_t run_count;
    std::size_t inside_count, straddling_count, undecided_count, whole_count;
    std::uint64_t nodes_tested, boxes_tested, accepted_whole;
    std::uint64_t improper;  // outside, found by a separating axis
};

// The children of `entry` that are not certainly outside, in the order of their lanes, as entries; returns how many (≤
// 16).
std::size_t expand_tree_kernel(const TreeKernelInput& input, std::uint64_t entry, std::uint64_t* entries);

// Handles the children that `stack_size` entries name, and all below them.
void run_tree_kernel(const TreeKernelInput& input, std::size_t stack_size, TreeKernelOutput& output);

}  // namespace crofton::cull
