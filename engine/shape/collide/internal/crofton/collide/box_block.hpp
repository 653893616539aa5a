// SPDX-License-Identifier: MIT
// Sixteen boxes side by side: plain arrays, which kernel files may read without any other header.
#pragma once
#include <crofton/core/version.hpp>
#include <cstddef>
#include <cstdint>

namespace crofton::collide {

inline constexpr std::size_t kBoxBlock = 16;

// Sixteen boxes side by side in float, centres relative to an origin; what the filter reads. 1 KiB.
struct alignas(64) BoxBlock {
    float center[3][kBoxBlock];
    float axes[3][3][kBoxBlock];  // [k][i]: component i of axis k
    float half[3][kBoxBlock];
    float deviation[kBoxBlock];  // of the axes from orthonormal; NaN for a box that is not finite
};

}  // namespace crofton::collide
