// SPDX-License-Identifier: MIT
// How lists of bounds lie in memory: plain arrays that vector kernels read as they are (no GLM here).
#pragma once
#include <crofton/core/version.hpp>
#include <cstddef>
#include <cstdint>

namespace crofton::cull {

// A list is cut into chunks of this many bounds, each with a frame of its own. Integers of 15 bits are then fine enough
// where neighbours in the list are neighbours in space, and right everywhere.
inline constexpr std::size_t kChunk = 4096;
inline constexpr std::int32_t kMaxRowCoordinate = 16383;
inline constexpr std::uint32_t kUnboundedRadius = 65535;

// Spheres around 16 bounds, in integers: 8 bytes a bound, and all that is read of most. A sphere's centre is the
// bound's, rounded to whole quanta from its chunk's origin; its radius in quanta is at least 1 + 2^-9 times the
// bound's. kUnboundedRadius: the row says nothing (the bound is beyond the frame, too large, or not finite).
struct alignas(64) RowBlock {
    std::uint32_t xy[16];  // x in the lower half, y in the upper, in two's complement
    std::uint32_t zr[16];  // z in the lower half, the radius, unsigned, in the upper
};

struct ListChunk {
    double origin[3];
    double quantum;                        // a power of two
    std::int32_t extent[3];                // ≥ |x|, |y|, |z| of its rows
    std::uint32_t largest_radius;          // of its rows
    float l1_radius;                       // ≥ |x| + |y| + |z| of its records
    std::uint32_t out_of_frame;            // bounds whose rows are empty
    std::uint32_t out_of_frame_at_layout;  // how many there were when the frame was chosen
};

// For bounds that their row cannot decide: the bound itself in floats, its centre relative to the chunk's origin. The
// centre is off by its own rounding, at most 2^-23 of l1_radius.

struct alignas(32) BoxRecord {
    float center[3];
    std::uint16_t radius;  // upper half of a float: at least that of the sphere around the box
    std::int16_t edge[9];  // half edges, component j of edge k at 3 k + j, each within one unit of 2^-15 · radius
};

struct alignas(32) AabbRecord {
    float center[3];
    float unit;     // the largest half extent, or a little more
    float half[3];  // of the unit
    float error;    // how far a face may be from the truth, but for the centre's rounding
};

struct alignas(16) SphereRecord {
    float center[3];
    float radius;  // rounded
};

}  // namespace crofton::cull
