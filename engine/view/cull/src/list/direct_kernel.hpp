// SPDX-License-Identifier: MIT
// One view against the caller's boxes, in vectors, without preparation or state.
#pragma once
#include "list/list_kernel.hpp"

namespace crofton::cull {

// Centres relative to the view's origin must stay below 1e30: so origins must be below this.
inline constexpr double kFarthestOrigin = 1e29;

struct DirectKernelInput {
    const unsigned char* boxes;  // array of Obb
    std::size_t count;           // 1 to kChunk
    const KernelView* view;      // has planes; its origin's components are at most kFarthestOrigin
    bool exact;
};

// Invalid boxes are reported as undecided.
void run_direct_kernel(const DirectKernelInput& input, ListKernelOutput& output);

}  // namespace crofton::cull
