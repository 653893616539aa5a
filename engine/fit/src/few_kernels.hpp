// Boxes around few points, sixteen at a time: the heart of the local search, compiled for every instruction set.
// Everything is in float and lanes never mix, so all instruction sets give the same bits.
#pragma once
#include <cstddef>
#include <cstdint>

#include "weights.hpp"

namespace crofton::fit::kernels {

inline constexpr std::size_t kLanes = 16;

struct FewPoints {
    const float* x;
    const float* y;
    const float* z;
    std::size_t count;  // at least 1; the arrays are readable up to the next multiple of kLanes
};

struct FloatWeights {
    float product, pairs, sum;
};

// ranks[i] = how many points come before point i in lexicographic order. Quadratic, and quick for all that: no
// branches.
void ranks(const FewPoints& points, float* ranks);

// Extreme points along kLanes directions: indices of the least and the greatest, the first of equals.
struct Directions {
    float x[kLanes], y[kLanes], z[kLanes];
};
void extremes(const FewPoints& points, const Directions& directions, float* least, float* greatest);

// Of `count` frames, a multiple of kLanes, the one of least value in each lane: frame i is in lane i % kLanes,
// component j of its axis k is frames[(3k + j) · count + i]. Writes values and i / kLanes, the first of equals.
void best_frames(const FewPoints& points, const FloatWeights& weights, const float* frames, std::size_t count,
                 float* values, float* rows);

// kLanes frames: component j of axis k of frame i is axes[3k + j][i].
struct FrameLanes {
    float axes[9][kLanes];
    float values[kLanes];
};
// Turns each frame about its axes, one after the other, to the best of a few angles within 12 degrees, then of smaller
// ones. Writes the values. `scratch` has room for 2 · kLanes · points.count floats.
void settle(const FewPoints& points, const FloatWeights& weights, float* scratch, FrameLanes& frames);
// Writes each frame's value and its support points: supports[side · kLanes + i] for side 2k along +axis k, 2k + 1 along
// −axis k.
void supports_of_frames(const FewPoints& points, const FloatWeights& weights, FrameLanes& frames, float* supports);

// For one frame, its three axes in sequence: one support point a side, the first of equals, and the widths.
void supports_of_frame(const FewPoints& points, const float frame[9], float supports[6], float widths[3]);

// A turn of a frame about `axis`, to the angle that is best as far as sixteen angles and the edges beside the best of
// them tell.
struct Turn {
    float axis[3], right[3], up[3];  // the frame
    float cosine, sine;              // result: the new `right` is cosine · right + sine · up
    float value;                     // result
};
// `scratch` has room for twice points.count floats, rounded up to kLanes.
void turn(const FewPoints& points, const FloatWeights& weights, float* scratch, Turn& turn);

// Frames (n, m, n × m) with n = start + t · across, normalised, and m perpendicular to n and `edge`: they keep two
// faces flush with two edges. start and across are unit vectors and perpendicular.
struct Slides {
    float start[3], across[3], edge[3];
    float t[kLanes];
    float values[kLanes];  // result; huge where edge and n are nearly parallel
};
void values_of_slides(const FewPoints& points, const FloatWeights& weights, Slides& slides);

// The first points, kMostFlush at most, that lie within `tolerance` of the face of each side, by index; `frame` as the
// three axes in sequence, side 2k along +axis k, 2k + 1 along −axis k. `scratch` has room for the points.
inline constexpr std::size_t kMostFlush = 4;
struct FlushSide {
    std::uint32_t indices[kMostFlush];
    std::size_t count;
};
void flush_points(const FewPoints& points, const float frame[9], float tolerance, float* scratch, FlushSide sides[6]);

}  // namespace crofton::fit::kernels
