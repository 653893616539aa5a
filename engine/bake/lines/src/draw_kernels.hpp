// SPDX-License-Identifier: MIT
// The inner loops of BundleTracer, on plain floats (no GLM here: see docs/architecture.md on vector kernels).
#pragma once
#include <cstddef>
#include <cstdint>

namespace crofton::lines::detail {

inline constexpr std::size_t kDrawLanes = 8;
inline constexpr std::size_t kChunkBlocks = 32, kChunk = kChunkBlocks * kDrawLanes;

// Corners of eight triangles; unused lanes have no area.
struct alignas(64) DrawnTriangles {
    float corner[3][3][kDrawLanes];  // [corner][axis]
};

// Space to grid: column = right·x + shift[0], row = up·x + shift[1], t = forward·x + shift[2].
struct GridFrame {
    float right[3], up[3], forward[3], shift[3];
    float columns, rows;
};

// A chunk of triangles as the grid sees them: corners, and the cells around them, [low, high) empty where none.
struct alignas(64) Projected {
    float x[3][kChunk], y[3][kChunk], t[3][kChunk];
    std::int32_t column_low[kChunk], column_high[kChunk], row_low[kChunk], row_high[kChunk];
};
void project(const DrawnTriangles* blocks, std::size_t count, const GridFrame& grid, Projected& out);

// Finds the candidates (triangle of the chunk, cell) that contain their cell's sample. Writes for each, in order: cell,
// triangle with kFront if the line comes from its front, t. Returns their number. `out_…` have room for count + 8.
std::size_t covered(const Projected& chunk, const std::uint32_t* triangles, const std::uint32_t* cells,
                    std::size_t count, const float* sample_x, const float* sample_y, std::uint32_t* out_cell,
                    std::uint32_t* out_triangle, float* out_t);

// Uniform places in cells: sample_x[i] in column + (0, 1), sample_y[i] in row + (0, 1).
void jitter_row(std::uint32_t seed, std::uint32_t first_cell, std::uint32_t columns, std::uint32_t row, float* sample_x,
                float* sample_y);

}  // namespace crofton::lines::detail
