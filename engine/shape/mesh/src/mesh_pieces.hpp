// SPDX-License-Identifier: MIT
// Finds the connected pieces of a mesh, and which of them are closed.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/geometry/mesh.hpp>
#include <cstdint>
#include <span>

namespace crofton::mesh {

// A vertex and the lowest one of equal position, where that makes two edges of a closed piece one, or joins a piece.
struct WeldedVertex {
    std::uint32_t vertex, lowest, piece;
};

// A vertex of what hangs together by index, in a piece of several such parts.
struct PartVertex {
    std::uint32_t vertex, piece;
};

struct MeshPieces {
    Vector<std::uint32_t> vertex;  // of each piece: one of its lowest triangle; pieces are in the order of these
    Vector<std::uint8_t> closed;   // of each piece, as MeshPiece says
    Vector<std::uint32_t> piece;   // of each triangle asked about
    Vector<WeldedVertex> welds;
    Vector<PartVertex> part_vertices;
    Vector<std::uint32_t> lowest;  // by vertex: the lowest that it was found to be at one place with
};

// Triangles are connected where they share a vertex: by index, or by equal position.
[[nodiscard]] MeshPieces find_pieces(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles);

}  // namespace crofton::mesh
