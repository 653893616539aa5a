// SPDX-License-Identifier: MIT
// Many views against a box tree, in vectors.
#pragma once
#include <crofton/boxtree/layout.hpp>

#include "kernel_view.hpp"

namespace crofton::cull {

struct ManyViewsInput {
    const boxtree::Node* nodes;
    const boxtree::Leaf* leaves;
    const boxtree::LeafRange* ranges;
    const std::uint8_t* leaf_counts;
    const boxtree::ItemId* slot_items;
    const boxtree::Axes* axes;
    std::uint32_t leaf_count;
    const KernelView* views;
    std::uint32_t view_count;
    bool exact;
    // The exact test for undecided items: does view v see the item in this slot?
    bool (*decide)(const void* context, std::uint32_t slot, std::uint32_t view);
    const void* context;
};

struct ManyViewsOutput {
    boxtree::ItemId* ids;    // room for all items and 16 more, as in masks
    void* masks;             // integers of mask_bytes
    std::size_t mask_bytes;  // 1, 2 or 4, with a bit for each view
    std::size_t count;
    // Scratch memory of the kernel. By leaf, with room for 16 more: the views that see it whole, and those that must
    // look into it, all 0 and left so. For each view: the planes that the leaf straddles.
    std::uint32_t* whole;
    std::uint32_t* open;
    std::uint16_t* planes;
    std::uint64_t* touched;  // a bit for every 16 leaves, 0 and left so
    std::uint32_t* listed;   // room for all leaves and 16 more
    std::uint64_t* stack;    // 16 entries a level
};

void run_many_views_kernel(const ManyViewsInput& input, ManyViewsOutput& output);

}  // namespace crofton::cull
