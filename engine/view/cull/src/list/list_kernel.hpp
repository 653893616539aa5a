// SPDX-License-Identifier: MIT
// One view against a chunk of a list, in vectors: the filter's verdicts, and the list of undecided bounds.
#pragma once
#include <crofton/cull/list_layout.hpp>

#include "kernel_view.hpp"

namespace crofton::cull {

template <class Record>
struct ListKernelInput {
    const RowBlock* rows;  // the chunk's
    const Record* records;
    const ListChunk* chunk;
    const KernelView* view;
    std::size_t count;
    bool exact;
};

// Bit i % 64 of word i / 64 is bound i's.
struct ListKernelOutput {
    std::uint64_t visible[kChunk / 64];  // not certainly outside
    std::uint64_t inside[kChunk / 64];
    std::uint32_t undecided[kChunk + 16];  // theirs are open
    std::size_t undecided_count, resolved_count;
    std::uint64_t false_positives, open;  // open: straddling or undecided
};

void run_list_kernel(const ListKernelInput<BoxRecord>& input, ListKernelOutput& output);
void run_list_kernel(const ListKernelInput<AabbRecord>& input, ListKernelOutput& output);
void run_list_kernel(const ListKernelInput<SphereRecord>& input, ListKernelOutput& output);

}  // namespace crofton::cull
