// SPDX-License-Identifier: MIT
// One spot light against one froxel in doubles: what vectors could not decide in a few rounds.
#pragma once
#include "exact/numbers.hpp"
#include "lights/froxel_kernel.hpp"

namespace crofton::cull {

// The froxel between two columns, rows and depths: boundaries are slope · w + start.
struct FroxelCell {
    double slope[2][2], start[2][2];  // by axis: column, row; by side
    double low, high;
};

// Whether they share a point, where that is certain although either is off by `eta` in all.
[[nodiscard]] Answer filter_spot(const KernelLight& spot, const FroxelCell& cell, double eta);

}  // namespace crofton::cull
