// SPDX-License-Identifier: MIT
// Draws prepared bodies into the tiles of a buffer, in vectors.
#pragma once
#include <cstdint>

#include "buffer_data.hpp"
#include "prepared.hpp"

namespace crofton::occlude {

struct DrawTarget {
    float* pixels;       // of the tile rows from first_tile_row on
    float* least;        // of each tile
    TileCovers* covers;  // of each tile
    float* front;        // of each tile
    std::uint32_t width, tile_columns;
    std::uint32_t first_tile_row, end_tile_row;
};

struct DrawBody {
    const PreparedBody* body;
    const Side* sides;  // the body's
    const DepthPlane* planes;
    std::uint32_t place;  // in the order of drawing
};

// Replaces the stored nearness of each covered pixel where the body is nearer.
void draw_body_kernel(const DrawBody& body, const DrawTarget& target);

// Uncovers the pixels [0, width) of each row of a tile row; those beyond count as covered.
void clear_tile_row(float* pixels, float* least, std::uint32_t tile_columns, std::uint32_t width, std::uint32_t rows);

}  // namespace crofton::occlude
