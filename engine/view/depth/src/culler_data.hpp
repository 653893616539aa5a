// SPDX-License-Identifier: MIT
// What the depth culler and its kernels share.
#pragma once
#include <crofton/depth/clustered_mesh.hpp>
#include <cstdint>
#include <limits>

namespace crofton::depth {

// Nearness: depth where it is reversed, −depth otherwise. More is nearer.
inline constexpr float kNothing = -std::numeric_limits<float>::infinity();

inline constexpr std::uint32_t kTile = 8;
inline constexpr std::uint32_t kTilePixels = kTile * kTile;

// At a pixel the picture is at least as near as its number, and as the floor of its tile.
struct Tiles {
    float* pixels;  // tile by tile, row by row
    float* least;   // at most the least nearness in the tile
    float* floors;
    std::uint8_t* written;        // 0: the pixels have not been written in this picture
    std::uint32_t columns, rows;  // of tiles
    std::uint32_t width, height;  // of pixels; those of tiles beyond count as infinitely near
};

struct PictureData {
    Tiles tiles;
    float half_width, half_height;
    float near_share;  // points are in front of the near plane where nearness ≤ near_share · w, in clip coordinates
    float infinitely_far;  // nearness there
    float grid;  // pixels by which a vertex may lie elsewhere along each axis: the grid's step, floats' rounding
};

// A matrix whose third row gives nearness.
struct ObjectData {
    float columns[4][4];
    float moved[4];  // by how much DepthObject::position_error moves clip coordinates
    bool one_sided, hides;
};

// By how much the clip coordinates of a cluster's vertices may be off, here and in the renderer together.
struct ClipErrors {
    float x, y, z, w;
};

enum class Coverage : std::uint8_t {
    nothing,  // no sample
    samples,
    unclear,  // reaches the near plane, or too close to the eye for a useful bound
};

// The samples [x0, x1] × [y0, y1] that a box may cover; its nearest possible nearness.
struct Projection {
    std::int32_t x0, y0, x1, y1;
    float nearest;
    float least_w;
    Coverage coverage;
    ClipErrors errors;
};

// A cluster to draw.
struct PatchData {
    const float* coordinates;
    const ClusteredMesh::Block* blocks;
    std::uint32_t vertex_count, triangle_count;
    float least_w;  // of the cluster's bound
    ClipErrors errors;
    bool unclear;  // as its projection
};

inline constexpr std::uint32_t kMaxPatchVertices = Cluster::kMaxTriangles * 3;

void project_bounds(const PictureData& picture, const ObjectData& object, const Cluster* clusters, std::size_t count,
                    Projection* to);
// True if all that may be covered is nearer already.
bool is_hidden(const Tiles& tiles, const Projection& projection);
// Draws the cluster; returns the triangles that may own a sample.
std::uint64_t draw_patch(const PictureData& picture, const ObjectData& object, const PatchData& patch);

}  // namespace crofton::depth
