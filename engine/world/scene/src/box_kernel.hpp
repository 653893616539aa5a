// SPDX-License-Identifier: MIT
// Computes the boxes of many instances at once.
#pragma once
#include <cstddef>

namespace crofton::scene {

inline constexpr std::size_t kBoxesAtOnce = 32;

// In and out of the kernel, one entry a lane, in groups of four numbers as they lie in memory.
struct BoxBlock {
    // In. A Transform's twelve numbers; a box's centre and one more; its axes and half extents, twelve floats.
    alignas(64) double world[3][kBoxesAtOnce][4] = {};
    alignas(64) double center[kBoxesAtOnce][4] = {};
    alignas(64) float shape[3][kBoxesAtOnce][4] = {};
    // Out, likewise. `done` is 1 where the box is that of transformed_box(), bit for bit, else 0.
    alignas(64) double image_center[kBoxesAtOnce][4] = {};
    alignas(64) float image_shape[3][kBoxesAtOnce][4] = {};
    alignas(64) double done[kBoxesAtOnce] = {};
};

// The first `count` lanes; others are left in any state. The same bits on every instruction set. Images whose edges are
// perpendicular are done, unless their numbers are near the limits.
void transform_boxes(BoxBlock& block, std::size_t count);

// Likewise where they are not perpendicular, by the criterion with these weights of volume, area and mean curvature.
// Flat images are not done.
void transform_sheared_boxes(BoxBlock& block, std::size_t count, const double (&weights)[3]);

}  // namespace crofton::scene
