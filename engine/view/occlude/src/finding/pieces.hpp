// SPDX-License-Identifier: MIT
// The pieces of a mesh: triangles connected by sides, where vertices of equal position count as one.
#pragma once
#include <array>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/geometry/shapes.hpp>
#include <cstdint>
#include <span>

namespace crofton::occlude {

inline constexpr float kMaxPosition = 1e12f;  // as mesh::MeshTree

struct Piece {
    std::uint32_t begin = 0, end = 0;  // of PieceMesh::order
    bool even = true;                  // every edge has an even number of triangles
    bool balanced = true;              // every edge is run through equally often in both directions
    bool manifold = true;              // balanced, and every edge has two triangles
};

// A triangle's side that another one shares; both run through it in opposite directions and no third one does.
inline constexpr std::uint32_t kNoNeighbor = ~std::uint32_t{0};

struct PieceMesh {
    Vector<glm::vec3> positions;                     // each once, −0 as 0
    Vector<std::array<std::uint32_t, 3>> triangles;  // valid ones: indices into positions
    Vector<std::uint32_t> source;                    // of each: its number in the mesh
    Vector<std::array<std::uint32_t, 3>> neighbors;  // of each: across the side from corner k to k + 1
    Vector<Piece> pieces;                            // by their lowest triangles
    Vector<std::uint32_t> order;                     // triangles, piece by piece, ascending in each
    Vector<std::uint32_t> rejected;                  // numbers in the mesh

    [[nodiscard]] std::span<const std::uint32_t> of(const Piece& piece) const {
        return std::span<const std::uint32_t>(order).subspan(piece.begin, piece.end - piece.begin);
    }
    [[nodiscard]] Triangle corners(std::uint32_t t) const {
        return {glm::dvec3(positions[triangles[t][0]]), glm::dvec3(positions[triangles[t][1]]),
                glm::dvec3(positions[triangles[t][2]])};
    }
};

// Requires an index count that is a multiple of three, and fewer than 2^28 triangles.
[[nodiscard]] PieceMesh split_into_pieces(const TriangleMesh& mesh);

// The winding number of the surface around the point, and the parity of its crossings; decided exactly. The sum of
// signs of the crossings of the ray along +z; no triangle contains the point.
struct Winding {
    int number = 0;
    bool odd = false;
};
[[nodiscard]] Winding winding_around(const PieceMesh& mesh, const Piece& piece, const glm::dvec3& point);

}  // namespace crofton::occlude
