// SPDX-License-Identifier: MIT
// Draws triangles and contours of a mesh's piece into its patch of tiles, in vectors.
#pragma once
#include <cstddef>
#include <cstdint>

namespace crofton::occlude {

// The tiles of a patch, row by row, and the pixels of the picture that are among them.
struct PatchTarget {
    float* values;           // 64 a tile: the least depth of any triangle there
    std::uint64_t* reached;  // a bit for each pixel of a tile: a triangle meets it
    std::uint64_t* contour;  // a bit for each pixel of a tile: an edge of the contour may meet it
    std::uint32_t first_column, first_row, columns;
    double low_x, low_y, high_x, high_y;  // the first and the last column and row
    double half_width, half_height;
    double margin;  // of the corners' columns and rows
};

// Corners in pixels from the picture's corner. Lines and planes are x · column + y · row + w, in pixels from the
// middle.
struct PatchTriangle {
    double x[3], y[3];
    double nearness[3];  // depth of its plane
    double lower;        // how much less it may be within a pixel
    double farthest;     // but nowhere less than this
    double sides[3][3];  // positive within
    double weights[3];   // of the corner across from a side
    double line;         // error of a side
    double limit;        // how far beyond the sides, weighted, the middle of a pixel may be that the triangle meets
};

struct PatchEdge {
    double x[2], y[2];
};

void draw_triangle_kernel(const PatchTriangle& triangle, const PatchTarget& target);
void draw_contour_kernel(const PatchEdge& edge, const PatchTarget& target);

// Keeps in `reached` the pixels that no contour meets, and uncovers the others.
void finish_patch_kernel(const PatchTarget& target, std::size_t tiles);

}  // namespace crofton::occlude
