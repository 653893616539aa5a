// SPDX-License-Identifier: MIT
// Many views against a chunk of a list, in vectors.
#pragma once
#include <crofton/cull/list_layout.hpp>

#include "kernel_view.hpp"

namespace crofton::cull {

inline constexpr std::size_t kMaxListViews = 32;

// The statistics of one view, without the rows, which are read once for all.
struct ListViewCost {
    std::uint64_t resolved, false_positives, straddling, undecided;
};

template <class Record>
struct ListViewsInput {
    const RowBlock* rows;  // the chunk's
    const Record* records;
    const ListChunk* chunk;
    const KernelView* views;
    std::uint32_t view_bits;  // which of them
    std::size_t count;
    bool exact;
    bool beyond_cache;            // the list is larger than what the cores' own caches hold
    const std::uint32_t* layers;  // of the chunk's bounds, or null: all are in all layers
    // The exact test for undecided bounds: does view v see bound i?
    bool (*decide)(void* context, std::uint32_t bound, std::uint32_t view);
    void* context;
};

void copy_masks(const std::uint32_t* from, std::size_t count, std::uint32_t* to);

// Bit v of masks[i]: view v sees bound i, and they share a layer. `costs`, by view, are added to.
void run_list_views_kernel(const ListViewsInput<BoxRecord>& input, std::uint32_t* masks, ListViewCost* costs);
void run_list_views_kernel(const ListViewsInput<AabbRecord>& input, std::uint32_t* masks, ListViewCost* costs);
void run_list_views_kernel(const ListViewsInput<SphereRecord>& input, std::uint32_t* masks, ListViewCost* costs);

}  // namespace crofton::cull
