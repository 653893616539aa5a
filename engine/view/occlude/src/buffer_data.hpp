// SPDX-License-Identifier: MIT
// The buffer's memory: tiles of 8 × 8 pixels, the least nearness of each, and of blocks of tiles.
#pragma once
#include <bit>
#include <crofton/core/memory.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <cstdint>

#include "pixel_map.hpp"
#include "prepared.hpp"

namespace crofton::occlude {

inline constexpr std::uint32_t kTile = 8;  // pixels a side
inline constexpr std::uint32_t kTilePixels = kTile * kTile;
inline constexpr float kUncovered = OcclusionBuffer::kUncovered;

// The bodies that cover pixels of a tile, whether or not something is nearer there. Holds a few of them: those that
// cover most.
struct TileCovers {
    static constexpr std::size_t kCount = 4;
    std::uint64_t pixels[kCount];  // bit 8 r + c for row r, column c; none: 0, and so are all that follow
    std::uint32_t bodies[kCount];  // by their place in the order

    void add(std::uint64_t covered, std::uint32_t body) {
        std::size_t least = 0;
        for (std::size_t i = 0; i < kCount; ++i) {
            if (pixels[i] == 0) {
                least = i;
                break;
            }
            if (std::popcount(pixels[i]) < std::popcount(pixels[least])) least = i;
        }
        if (std::popcount(pixels[least]) >= std::popcount(covered)) return;
        pixels[least] = covered;
        bodies[least] = body;
    }
};

// The planes of a body's shadow, in groups; those of its faces first.
struct BodyShadow {
    const float* groups;
    std::uint32_t faces, count;
};

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
    Vector<Order> order;         // front to back
    Vector<BodyShadow> shadows;  // of the bodies in this order; they point into the chunks
    Vector<TileCovers> covers;   // by tiles
    Vector<float> front;         // of each tile: nothing that is drawn there is nearer, or hardly anything
};

}  // namespace crofton::occlude
