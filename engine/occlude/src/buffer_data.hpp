// SPDX-License-Identifier: MIT
// The buffer's memory: tiles of 8 × 8 pixels, the least nearness of each, and of blocks of tiles.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <cstdint>

#include "pixel_map.hpp"
#include "prepared.hpp"

namespace crofton::occlude {

inline constexpr std::uint32_t kTile = 8;  // pixels a side
inline constexpr std::uint32_t kTilePixels = kTile * kTile;
inline constexpr float kUncovered = OcclusionBuffer::kUncovered;

// Level 0 has a number for each tile, the least of its pixels; level l one for each 2^l × 2^l tiles. Each row of a
// level is `tile_columns` long, and level l begins with row 2 R − (2 R >> l), R = padded_rows.
struct OcclusionBuffer::Data {
    BufferSize size;
    std::uint32_t tile_columns = 0, tile_rows = 0;
    Vector<float> pixels;           // by tiles, row by row; pixels beyond the picture's edge are covered by all
    Vector<float> least;            // by levels
    std::uint32_t padded_rows = 0;  // a power of two, not below either number of tiles

    OcclusionView view;
    PixelMap map{};
    bool drawn = false;
    DrawStatistics statistics;

    Vector<PreparedBodies> chunks;  // of occluders; the first chunk_count are in use
    std::size_t chunk_count = 0;
    struct Order {
        float most_nearness;
        std::uint32_t chunk, body;
    };
    Vector<Order> order;  // front to back
};

}  // namespace crofton::occlude
