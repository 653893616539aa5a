// SPDX-License-Identifier: MIT
// The parts of a mesh tree: the nodes and leaves that queries read, and the data for a refit.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/mesh/mesh_layout.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::mesh {

// Two vertices of equal position that close a piece or hold it together.
struct VertexWeld {
    std::uint32_t vertex, other, piece;
};

// A vertex of each part of a piece that equal positions hold together.
struct PieceWitness {
    std::uint32_t vertex, piece;
};

// Empty in a tree that is not refittable.
struct MeshRefitData {
    Vector<LeafVertices> leaves;
    Vector<BoxAnchors> nodes;
    BoxAnchors root{};
    Vector<std::uint32_t> piece_vertices;
    Vector<std::uint8_t> piece_closed;  // at the build
    Vector<VertexWeld> welds;
    Vector<PieceWitness> witnesses;
    Vector<std::uint8_t> piece_parted;  // by the last refit
    std::size_t vertex_count = 0;
};

struct MeshParts {
    Vector<MeshNode> nodes;  // the root is the first
    Vector<MeshLeaf> leaves;
    Vector<BoxNode> ray_nodes;  // the root is the first; empty where rays are not prepared
    MeshBox root_box{};
    MeshRefitData refit;
    // The first `loose_count` are points of the parts of pieces that the last refit has parted, one of each.
    // Containment asks for them beside the pieces' own.
    Vector<glm::vec3> loose_points;
    std::size_t loose_count = 0;

    [[nodiscard]] Triangle triangle(const LeafTriangle& at) const {
        const MeshLeaf& leaf = leaves[at.leaf];
        const auto vertex = [&](int v) {
            return glm::dvec3(
                glm::vec3(leaf.vertex[v][0][at.lane], leaf.vertex[v][1][at.lane], leaf.vertex[v][2][at.lane]));
        };
        return {vertex(0), vertex(1), vertex(2)};
    }
    [[nodiscard]] Aabb bounds() const {  // of all vertices
        Aabb box;
        for (const MeshLeaf& leaf : leaves)
            for (std::uint32_t lane = 0; lane < leaf.count; ++lane)
                for (const auto& vertex : leaf.vertex)
                    box.include(glm::dvec3(glm::vec3(vertex[0][lane], vertex[1][lane], vertex[2][lane])));
        return box;
    }
    [[nodiscard]] std::span<const glm::vec3> loose() const { return {loose_points.data(), loose_count}; }

    // Takes over a hierarchy whose leaf i is the leaf leaf_of[i] here.
    void take_ray_nodes(Vector<BoxNode> hierarchy, std::span<const std::uint32_t> leaf_of);
    void refit_ray_nodes();
};

}  // namespace crofton::mesh
