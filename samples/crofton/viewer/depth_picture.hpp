// SPDX-License-Identifier: MIT
// A depth buffer of occluders as a picture: near is bright, far is dark, what is open is blue.
#pragma once
#include <crofton/occlude/occlusion.hpp>
#include <cstdint>
#include <vector>

namespace crofton::viewer {

struct DepthPicture {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint32_t> rgba;       // red in the lowest byte; the top row first
    double nearest = 0.0, farthest = 0.0;  // of the covered pixels, along the view; 0 where none is
    double covered = 0.0;                  // share of the pixels
};

// In the colours of a display. `share` is 0 for what is nearest and 1 for what is farthest, evenly in the logarithm of
// the distance.
[[nodiscard]] std::uint32_t depth_color(double share);
inline constexpr std::uint32_t kOpenColor = 0xff5a2a10;  // no occluder covers the pixel

// Keeps the picture's memory.
void paint_depth(const occlude::OcclusionBuffer& buffer, DepthPicture& picture);

}  // namespace crofton::viewer
