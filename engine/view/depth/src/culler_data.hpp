// SPDX-License-Identifier: MIT
// Data that the depth culler shares with its kernels.
#pragma once
#include <crofton/depth/clustered_mesh.hpp>
#include <crofton/depth/depth_culler.hpp>
#include <cstdint>
#include <limits>

#include "patch.hpp"

namespace crofton::depth {

// Nearness: depth where it is reversed, −depth otherwise. More is nearer.
inline constexpr float kNothing = -std::numeric_limits<float>::infinity();

inline constexpr std::uint32_t kTile = 8;
inline constexpr std::uint32_t kTilePixels = kTile * kTile;

// At a pixel the picture is at least as near as its number, and as the floor of its tile. Tile (x, y) of the picture is
// at y · columns + x of each list; only those from first_x to last_x are there.
struct Tiles {
    float* pixels;  // tile by tile, row by row
    float* least;   // the least nearness in the tile
    float* floors;
    std::uint8_t* written;         // 0: the pixels have not been written in this picture
    std::uint32_t columns;         // tiles in a row
    std::uint32_t width, height;   // pixels of the picture; those of tiles beyond count as infinitely near
    std::int32_t first_x, last_x;  // pixels
};

struct PictureData {
    Tiles tiles;
    float half_width, half_height;
    float middle_x, middle_y;  // in pixels, so that the sample at hand is in the middle of each
    float near_share;  // points are in front of the near plane where nearness ≤ near_share · w, in clip coordinates
    float infinitely_far;  // nearness there
    float grid;    // pixels by which a vertex may lie elsewhere along each axis: the grid's step, floats' rounding
    float z_sign;  // of nearness in the third row of DepthObject::to_clip
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

// The samples [x0, x1] × [y0, y1] that a box may cover; its nearest possible nearness.
struct Projection {
    std::uint16_t x0, x1, y0, y1;
    float nearest;
    float least_w;  // 0: the box reaches the near plane, or is too close to the eye for a useful bound

    [[nodiscard]] bool covers_nothing() const { return x0 > x1; }
    [[nodiscard]] bool is_unclear() const { return least_w == 0.0f; }
};

// A cluster to draw.
struct PatchData {
    Patch& patch;             // opened
    const ClusterBox& bound;  // that `projection` is of
    const Projection& projection;
};

// A triangle in a shadow map: texels, and negated nearness. Lookups read what is up to `reach` away, with up to
// depth_error more or less.
struct MapTriangle {
    double x[3], y[3], z[3];
    double x_per_row[3], z_per_row[3];  // along the edge from each corner to the next
    double reach, depth_error;
};

// Of each object as a whole. Objects that cannot be placed get a negative least_w, and cover nothing.
void project_objects(const PictureData& picture, const DepthObject* objects, std::size_t count, Projection* to);
// Of an object's clusters: within the projection of the object. Writes up to 7 more than there are.
void project_clusters(const PictureData& picture, const ObjectData& object, const Projection& within,
                      const ClusteredMesh::PackedBox* boxes, std::size_t count, Projection* to);
// The same of boxes that are not packed.
void project_boxes(const PictureData& picture, const ObjectData& object, const Projection& within,
                   const ClusterBox* boxes, std::size_t count, Projection* to);
// True if all that may be covered is nearer already, as far as the tiles are there.
bool is_hidden(const Tiles& tiles, const Projection& projection);
// Returns the first of objects[begin, end) that is not hidden, or `end`.
std::size_t first_shown(const Tiles& tiles, const Projection* projections, const std::uint32_t* objects,
                        std::size_t begin, std::size_t end);
// Draws the cluster; returns the triangles that may own a sample, as far as the tiles are there.
std::uint64_t draw_patch(const PictureData& picture, const ObjectData& object, const PatchData& patch);
// Asks the triangles of a cluster that is unclear, once all is drawn; returns those that may own a sample, as far as
// the tiles are there, and those of which that is not known.
std::uint64_t ask_patch(const PictureData& picture, const ObjectData& object, const PatchData& patch);
// Lowers the floors of a map, row by row of tiles, to the farthest point that a lookup in the triangle's part of each
// row may have. Returns false if there is none. `width`: of the map, in texels.
bool mark_rows(const MapTriangle& triangle, std::uint32_t first_row, std::uint32_t last_row, std::uint32_t width,
               float* floors);

}  // namespace crofton::depth
