// SPDX-License-Identifier: MIT
// The parts of a mesh tree: nodes and leaves that queries read, and what a refit needs.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/mesh/mesh_layout.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <cstdint>

namespace crofton::mesh {

// Two vertices of equal position that close a piece.
struct VertexWeld {
    std::uint32_t vertex, other, piece;
};

// Empty in a tree that is not refittable.
struct MeshRefitData {
    Vector<LeafVertices> leaves;
    Vector<BoxAnchors> nodes;
    BoxAnchors root{};
    Vector<std::uint32_t> piece_vertices;
    Vector<std::uint8_t> piece_closed;  // at the build
    Vector<VertexWeld> welds;
    std::size_t vertex_count = 0;
};

struct MeshParts {
    Vector<MeshNode> nodes;  // the root is the first
    Vector<MeshLeaf> leaves;
    Vector<BoxNode> ray_nodes;  // the root is the first; empty where rays are not prepared
    MeshBox root_box{};
    MeshRefitData refit;

    void refit_ray_nodes();
};

}  // namespace crofton::mesh
