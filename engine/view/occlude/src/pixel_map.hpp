// SPDX-License-Identifier: MIT
// A view in pixels: the map for occluders and for queried boxes.
#pragma once
#include <crofton/occlude/occlusion.hpp>
#include <cstdint>

namespace crofton::occlude {

// A plane that cuts occluders off: column · x + row · y + w + z · nearness ≥ 0 in pixels, and its value at points.
struct CutPlane {
    double column, row, constant, nearness;
    double form[4];  // value = form · (x − origin, 1), within `error` · Σ|form_k| |x_k| of it
};

// Coordinates are pixels from the middle of the picture. The window is shrunk by kGuard pixels on each side. So rays at
// the rim of the view still fall into the picture, whatever the rounding of its planes.
struct PixelMap {
    static constexpr double kGuard = 0x1p-6;

    double origin[3];
    double form[4][4];  // column, row, w, z
    CutPlane cuts[2];
    int cut_count;
    double least_w;
    double half_width, half_height;
    std::uint32_t width, height;
    bool perspective;
    bool mirrored;         // triangles that are counter-clockwise seen from the eye are clockwise in the picture
    double most_nearness;  // of a point beyond the cuts and in the window
};

[[nodiscard]] PixelMap pixel_map_of(const OcclusionView& view, std::uint32_t width, std::uint32_t height);

}  // namespace crofton::occlude
