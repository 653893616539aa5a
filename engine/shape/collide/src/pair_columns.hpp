// SPDX-License-Identifier: MIT
// Two boxes as the tests of one pair lay them out: plain arrays, which kernel files may read without any other header.
//
// The fifteen axes go in five groups of three, side by side: face normals of a, face normals of b, and three groups of
// edge pairs, lane i of group k being edge i of a × edge i + k of b. Then every term of every group is one of the
// columns below, or of the products of a's and b's, turned by one or two lanes: nothing is transposed on the way.
#pragma once
#include <array>
#include <cstdint>

namespace crofton::collide {

struct alignas(16) PairColumns {
    float a[3][4], b[3][4];  // [c][i]: component c of axis i; the last lane is anything
    float half_a[4], half_b[4];
    double offset[3];  // center_b − center_a, rounded
};

// Sets of axes, one bit each, numbered as in narrow_phase.hpp; from three bits a group.
inline constexpr auto kEdgeAxes = [] {
    std::array<std::array<std::uint32_t, 8>, 3> axes{};
    for (std::uint32_t k = 0; k < 3; ++k)
        for (std::uint32_t lanes = 0; lanes < 8; ++lanes)
            for (std::uint32_t i = 0; i < 3; ++i) axes[k][lanes] |= (lanes >> i & 1u) << (6 + 3 * i + (i + k) % 3);
    return axes;
}();
[[nodiscard]] constexpr std::uint32_t axis_set(const std::uint32_t (&lanes)[5]) {
    return lanes[0] | lanes[1] << 3 | kEdgeAxes[0][lanes[2]] | kEdgeAxes[1][lanes[3]] | kEdgeAxes[2][lanes[4]];
}

inline constexpr std::uint32_t kAllAxes = 0x7fff;

// Each axis surely separates, is unknown, or surely does not. A box that is not finite never overlaps along all axes.
struct AxisVerdicts {
    std::uint32_t separated = 0, unknown = 0;
};

// The group of an axis and its lane in there.
struct AxisPlace {
    int group, lane;
};
[[nodiscard]] constexpr AxisPlace place_of(int axis) {
    if (axis < 6) return {axis / 3, axis % 3};
    const int i = (axis - 6) / 3, j = (axis - 6) % 3;
    return {2 + (j - i + 3) % 3, i};
}

// Of each axis, by group and lane: the gap along it, which is negative where the boxes overlap, times its length, and
// the square of that length. Gaps are off by less than 2^-49 of `size`, the sum of all half extents and |offset|₁.
// `face` and `edge` are the first axes of the largest gap per length among faces and among edges that are not
// parallel; `edge` is −1 where all are. `surely_meet` and `surely_apart` are judge_axes' verdicts.
struct AxisMeasures {
    alignas(32) double gap[5][4], squared_length[5][4];
    double size;
    int face, edge;
    bool edge_is_widest;  // beyond the face
    bool surely_meet, surely_apart;
};
void measure_axes(const PairColumns& pair, AxisMeasures& measures);

// All fifteen axes in double, three or four lanes at a time.
[[nodiscard]] AxisVerdicts judge_axes(const PairColumns& pair);

}  // namespace crofton::collide
