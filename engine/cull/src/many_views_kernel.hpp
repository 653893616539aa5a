// Many views against a box tree, in vectors.
#pragma once
#include <crofton/tree/layout.hpp>

#include "kernel_view.hpp"

namespace crofton::cull {

// A subtree, and what is still to be asked of it for each view: 10 words of 64 bits.
struct ManyViewsEntry {
    std::uint32_t child;
    std::uint32_t straddling;  // views with planes left to test
    std::uint32_t whole;       // views that see everything below
    std::uint16_t planes[32];
};

struct ManyViewsInput {
    const tree::Node* nodes;
    const tree::Leaf* leaves;
    const tree::LeafRange* ranges;
    const std::uint8_t* leaf_counts;
    const tree::ItemId* slot_items;
    const KernelView* views;
    std::uint32_t view_count;
    bool exact;
    // What vectors cannot decide: does view v see the item in this slot?
    bool (*decide)(const void* context, std::uint32_t slot, std::uint32_t view);
    const void* context;
};

struct ManyViewsOutput {
    tree::ItemId* ids;
    std::uint32_t* masks;
    ManyViewsEntry* stack;
    std::size_t count;
};

void run_many_views_kernel(const ManyViewsInput& input, ManyViewsOutput& output);

}  // namespace crofton::cull
