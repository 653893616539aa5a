// SPDX-License-Identifier: MIT
// A cluster as the kernels read it.
//
// A mesh keeps for each corner of a cluster the number of its vertex, in as few bits as the cluster's numbers need.
// Vertices are numbered in the order in which corners name them, so a corner with a new number tells where in the index
// buffer its vertex is. Which triangles meet along an edge is found when a cluster is drawn.
#pragma once
#include <bit>
#include <crofton/depth/clustered_mesh.hpp>
#include <cstddef>
#include <cstdint>

namespace crofton::depth {

inline constexpr std::uint32_t kLanes = 8;
inline constexpr std::uint32_t kMaxPatchVertices = Cluster::kMaxTriangles * 3;
inline constexpr std::uint8_t kNoNeighbor = 0xff;

constexpr std::uint32_t padded(std::uint32_t count) {
    return (count + kLanes - 1) / kLanes * kLanes;
}

// Of each corner's number.
constexpr std::uint32_t bits_for(std::uint32_t vertex_count) {
    return vertex_count > 2 ? static_cast<std::uint32_t>(std::bit_width(vertex_count - 1)) : 1;
}

// Eight triangles; those beyond the cluster's last have three equal corners and no neighbours.
struct PatchBlock {
    std::uint8_t corners[3][kLanes];  // vertices of the patch
    // The triangle across the edge from corner k to k + 1: 4 · triangle of the patch + its edge, or kNoNeighbor.
    std::uint8_t neighbors[3][kLanes];
};

struct Patch {
    std::uint32_t vertex_count = 0, triangle_count = 0;
    const std::uint32_t* corner_words = nullptr;  // as the mesh keeps them, from bit first_bit on
    std::uint32_t first_bit = 0, corner_bits = 1;
    const std::uint32_t* indices = nullptr;  // of its triangles; null where its vertices follow one another
    const std::uint32_t* order = nullptr;    // null, or the numbers of its triangles, and `indices` are the mesh's
    const glm::vec3* positions = nullptr;
    bool has_twins = false;

    alignas(64) float coordinates[3][kMaxPatchVertices];  // padded() as the last vertex
    PatchBlock blocks[Cluster::kMaxTriangles / kLanes] = {};
    // Edge k of triangle t, from vertex a to b, has the number a · vertex_count + b. It is at 4 t + k.
    alignas(64) std::int32_t edges[4 * Cluster::kMaxTriangles] = {};
    // 4 t + k, by the edge's number. Those of clusters that were here before are left: each is compared with what it
    // names.
    std::uint8_t owners[kMaxPatchVertices * kMaxPatchVertices] = {};

    [[nodiscard]] glm::vec3 vertex(std::size_t v) const {
        return {coordinates[0][v], coordinates[1][v], coordinates[2][v]};
    }
    // Returns the position of the vertex with this number. Corner k of the triangle is the first that names it.
    [[nodiscard]] const glm::vec3& position_of(std::uint32_t triangle, std::uint32_t k, std::uint32_t number) const {
        if (indices == nullptr) return positions[number];
        return positions[indices[std::size_t{3} * (order != nullptr ? order[triangle] : triangle) + k]];
    }
    [[nodiscard]] std::uint32_t corner(std::uint32_t triangle, std::size_t k) const {
        return blocks[triangle / kLanes].corners[k][triangle % kLanes];
    }
};

// Reads clusters of a mesh. The kernels do the same, eight triangles at once (unpack-inl.hpp).
class PatchReader {
  public:
    // Sets all but the number of vertices and what is listed by vertex, triangle or edge.
    static void open(const ClusteredMesh& mesh, std::size_t cluster, Patch& to);
    // Sets the number of vertices and the corners, too. False if vertices are not numbered as corners name them.
    static bool read_corners(const ClusteredMesh& mesh, std::size_t cluster, Patch& to);
    // Sets coordinates, too, of a sound mesh.
    static void read(const ClusteredMesh& mesh, std::size_t cluster, Patch& to);
};

}  // namespace crofton::depth
