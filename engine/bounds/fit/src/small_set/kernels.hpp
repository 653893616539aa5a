// SPDX-License-Identifier: MIT
// Kernels of the local search on a small set of points: sixteen frames at a time, compiled for every instruction set.
// They compute in float, and no value depends on the vector's width, so all instruction sets give the same bits.
#pragma once
#include <cstddef>
#include <cstdint>

#include "search/weights.hpp"

namespace crofton::fit::kernels {

inline constexpr std::size_t kLanes = 16;

// The points' coordinates, in separate arrays.
struct SmallSet {
    const float* x;
    const float* y;
    const float* z;
    std::size_t count;  // at least 1; the arrays are readable up to the next multiple of kLanes
};

struct FloatWeights {
    float product, pairs, sum;
};

// ranks[i] = how many points come before point i in lexicographic order. Quadratic, without branches.
void find_ranks(const SmallSet& points, float* ranks);

// Extreme points along kLanes directions: indices of the least and the greatest, the first of equals.
struct Directions {
    float x[kLanes], y[kLanes], z[kLanes];
};
void find_extremes(const SmallSet& points, const Directions& directions, float* least, float* greatest);

// Finds the frame of least value in each lane, of `count` frames, a multiple of kLanes. Frame i is in lane i % kLanes;
// component j of its axis k is frames[(3k + j) · count + i]. Writes values and i / kLanes, the first of equals.
void best_frames(const SmallSet& points, const FloatWeights& weights, const float* frames, std::size_t count,
                 float* values, float* rows);

// kLanes frames: component j of axis k of frame i is axes[3k + j][i].
struct FrameLanes {
    float axes[9][kLanes];
    float values[kLanes];
};
// Lowers each frame's value. Turns it about its three axes in turn, each time to the best of nine angles within 12
// degrees, then again within 3. Writes the values. Requires room for 2 · kLanes · points.count floats in `scratch`.
void descend_frames(const SmallSet& points, const FloatWeights& weights, float* scratch, FrameLanes& frames);
// Writes each frame's value and its support points: supports[side · kLanes + i] for side 2k along +axis k, 2k + 1 along
// −axis k.
void supports_of_frames(const SmallSet& points, const FloatWeights& weights, FrameLanes& frames, float* supports);

// For one frame, its three axes in sequence: one support point a side, the first of equals, and the widths.
void supports_of_frame(const SmallSet& points, const float frame[9], float supports[6], float widths[3]);

// A turn of a frame about `axis` to the best of 32 angles. First sixteen over a right angle; then those that make a
// side flush with one of the sixteen chords between support points next to the best of these.
struct Turn {
    float axis[3], right[3], up[3];  // the frame
    float cosine, sine;              // result: the new `right` is cosine · right + sine · up
    float value;                     // result
};
// Requires room for twice points.count floats, rounded up to kLanes, in `scratch`.
void turn_frame(const SmallSet& points, const FloatWeights& weights, float* scratch, Turn& turn);

// Frames (n, m, n × m) with n = start + t · across, normalised, and m perpendicular to n and `edge`: two faces stay
// flush with an edge each. start and across are perpendicular unit vectors.
struct Slides {
    float start[3], across[3], edge[3];
    float t[kLanes];
    float values[kLanes];  // result; huge where edge and n are nearly parallel
};
void values_of_slides(const SmallSet& points, const FloatWeights& weights, Slides& slides);

// For each side the first points, kMostFlush at most, that lie within `tolerance` of its face, by index. `frame` holds
// the three axes in sequence; side 2k is along +axis k, 2k + 1 along −axis k. Requires room for points.count floats,
// rounded up to kLanes, in `scratch`.
inline constexpr std::size_t kMostFlush = 4;
struct FlushSide {
    std::uint32_t indices[kMostFlush];
    std::size_t count;
};
void flush_points(const SmallSet& points, const float frame[9], float tolerance, float* scratch, FlushSide sides[6]);

}  // namespace crofton::fit::kernels
