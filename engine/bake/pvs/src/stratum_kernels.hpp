// SPDX-License-Identifier: MIT
// The lines of a stratum from random bits, many at a time, on plain doubles (no GLM here: see docs/architecture.md on
// vector kernels).
#pragma once
#include <cstddef>
#include <cstdint>

namespace crofton::pvs::kernels {

inline constexpr std::size_t kStratumLines = 64;

// Part of the lines that enter a box through one face. Two numbers of the unit cube are the place (s, t) on the face.
// The direction's shadow on the face is a point of the unit disc: the other two are its squared radius and its angle in
// turns.
struct LineStratum {
    double low[4], length[4];    // of the unit cube
    double corner[2], sides[2];  // of the face, along s and t
    double plane;                // of the face, along its axis
    double inward;               // +1 where lines run upward along the axis, −1 where downward
    unsigned axis;               // 0, 1, 2: x, y, z; s and t are the next two
};

// kStratumLines lines of six doubles each, point and direction. Of each line two numbers of `bits`: 32 bits each for
// the four of the cube, lower halves first. The same bits for any instruction set: those of sampling::disc_point.
void draw_stratum(const LineStratum& stratum, const std::uint64_t* bits, double* lines);

}  // namespace crofton::pvs::kernels
