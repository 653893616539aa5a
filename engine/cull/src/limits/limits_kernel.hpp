// SPDX-License-Identifier: MIT
// One view against a box tree where draw limits hold.
#pragma once
#include <crofton/cull/draw_limits.hpp>

#include "tree/tree_kernel.hpp"

namespace crofton::cull {

// Squares of limits; [0] for all items, [1] for those that hysteresis keeps longer. What is off is infinite, or 0 for
// the least radius. What floats cannot square is off in [1], where it would drop, and in [0] keeps nothing.
struct KernelLimits {
    double eye[3];
    float radii[2];
    float least_radius[2];
    bool has_layers, has_items, has_sizes;
    // Of an item in these layers; of any item in some of them. NaN where floats cannot square it.
    float (*layer_square)(const void* limits, std::uint32_t common_layers, bool least_of_all);
    const void* limits;
    float longer_square;
};

[[nodiscard]] KernelLimits kernel_limits_of(const DrawLimits& limits);

// Like run_tree_kernel from the root, for trees whose boxes are valid; `undecided` are also the slots whose items may
// be beyond a limit. `runs` and `whole_count` are not used.
void run_limits_kernel(const TreeKernelInput& input, const KernelLimits& limits, TreeKernelOutput& output);

}  // namespace crofton::cull
