// SPDX-License-Identifier: MIT
// The memory layout of a mesh tree: plain arrays, which kernel files may read without any other header.
#pragma once
#include <crofton/core/version.hpp>
#include <cstdint>

namespace crofton::mesh {

inline constexpr std::uint32_t kMeshNodeWidth = 16;      // boxes to a node: a vector of floats
inline constexpr std::uint32_t kMeshLeafWidth = 8;       // triangles to a leaf: a vector of doubles
inline constexpr std::uint32_t kMeshLeaf = 0x80000000u;  // set in a child that is a leaf: the rest is its index

// Boxes of up to sixteen children side by side, as one vector load wants them. Lane l's box holds every triangle below
// it.
struct alignas(64) MeshNode {
    float center[3][kMeshNodeWidth];
    float axes[3][3][kMeshNodeWidth];  // [k][i]: component i of axis k; orthonormal to 1.5e-6
    float half[3][kMeshNodeWidth];
    std::uint32_t child[kMeshNodeWidth];
    std::uint32_t count;  // lanes in use: the first ones
};

// Up to eight triangles, vertices side by side. Unused lanes repeat the last triangle.
struct alignas(64) MeshLeaf {
    float vertex[3][3][kMeshLeafWidth];  // [v][i]: component i of vertex v, exactly the mesh's own
    std::uint32_t triangle[kMeshLeafWidth];
    std::uint32_t piece[kMeshLeafWidth];  // connected pieces: indices in MeshTree::pieces()
    std::uint32_t count;
};

// Where a triangle is: a lane of a leaf.
struct LeafTriangle {
    std::uint32_t leaf = 0, lane = 0;
};

// Aligned boxes side by side, for rays and lines: a slab test of them has a third of the latency of an oriented box's.
// Unused lanes are empty.
inline constexpr std::uint32_t kBoxNodeWidth = 8;
struct alignas(64) BoxNode {
    float bounds[6][kBoxNodeWidth];      // low x, y, z; high x, y, z
    std::uint32_t child[kBoxNodeWidth];  // as MeshNode::child
    std::uint32_t count;                 // lanes in use: the first ones
};

struct MeshBox {
    float center[3], axes[3][3], half[3];
};

// The vertices of a leaf's triangles, by index: where a refit finds their new positions.
struct LeafVertices {
    std::uint32_t vertex[3][kMeshLeafWidth];
};

// How the boxes of a node are turned when vertices move. Three vertices of each box, far apart, span a frame; the box
// keeps its axes in that frame.
struct alignas(64) BoxAnchors {
    float axes[3][3][kMeshNodeWidth];  // [k][i]: component i of axis k, in the frame of the three vertices
    std::uint32_t vertex[3][kMeshNodeWidth];
    std::uint32_t first_leaf[kMeshNodeWidth], end_leaf[kMeshNodeWidth];  // the leaves below each box
};

}  // namespace crofton::mesh
