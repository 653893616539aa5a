// SPDX-License-Identifier: MIT
// The float filter over blocks of box pairs: what kernel files and the code around them share.
#pragma once
#include <crofton/collide/box_block.hpp>

namespace crofton::collide {

// The error of a gap, as a share of the boxes' size: rounding, and this times how far their axes are from orthonormal.
inline constexpr float kRounding = 0x1p-19f, kPerDeviation = 32.0f;
// A gap along a cross product of edges is at most that along the worst face normal, plus a remainder. The remainder is
// this times the sine of the edges' angle times the size.
inline constexpr float kPerSine = 2.5f;

// One bit a pair: surely separated by which group of axes (the first that applies), surely meeting; the rest is open.
struct BlockVerdict {
    std::uint32_t face_a = 0, face_b = 0, edges = 0, hit = 0;
};

// Tests sixteen pairs. b's centres are offsets from a's, which are not read.
BlockVerdict filter_block(const BoxBlock& a, const BoxBlock& b);

// Fills deviation[] from axes[].
void measure_deviation(BoxBlock& block);

}  // namespace crofton::collide
