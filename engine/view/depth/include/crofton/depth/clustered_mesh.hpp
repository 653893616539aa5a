// SPDX-License-Identifier: MIT
// Meshes cut into clusters: small groups of neighbouring triangles that a view lists or drops as one.
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::depth {

// The triangles [first_triangle, first_triangle + triangle_count) of ClusteredMesh::triangle_order(), and a box in
// model coordinates that contains them.
struct Cluster {
    static constexpr std::uint32_t kMaxTriangles = 64;  // a set of its triangles fits into one 64-bit number

    std::uint32_t first_triangle = 0;
    std::uint32_t triangle_count = 0;
    glm::vec3 center{0.0f};
    std::array<glm::vec3, 3> half_edges{};  // centre ± each of the three gives the box's corners
};

struct ClusterOptions {
    // 1 to Cluster::kMaxTriangles; 0 chooses: 16 for meshes of up to 1,000 triangles, 64 for those of 10,000 and more,
    // and between them in proportion.
    std::uint32_t max_triangles = 0;
};

// A mesh as DepthCuller reads it: its clusters, and the triangles that meet along each edge. Copies the positions; the
// caller's index buffer is permuted by triangle_order(), so that each cluster is one range of it.
class ClusteredMesh {
  public:
    // Cuts by expected cost: each cut minimises Σ (triangles in whole clusters) × (surface area of their box), by
    // Cauchy's formula the expected number of triangles that random views have to pass. Takes O(n log n) time.
    //
    // Vertices with equal positions count as one, so it does not matter whether the mesh is welded.
    //
    // Errors: options out of range; no triangles; a position that is not finite or beyond 1e15 (item = vertex); an
    // index out of range or a count that is not a multiple of 3 (item = index); more than 2^28 triangles.
    [[nodiscard]] static Result<ClusteredMesh> cut(std::span<const glm::vec3> positions,
                                                   std::span<const std::uint32_t> indices,
                                                   const ClusterOptions& options = {});

    // Triangle k of the permuted mesh is triangle triangle_order()[k] of the mesh that was given.
    [[nodiscard]] std::span<const std::uint32_t> triangle_order() const { return {order_.data(), order_.size()}; }
    // Writes the triangles of `indices`, three numbers each, in that order to `to`. Requires as many of both as were
    // cut.
    void permute(std::span<const std::uint32_t> indices, std::span<std::uint32_t> to) const;

    [[nodiscard]] std::span<const Cluster> clusters() const { return {clusters_.data(), clusters_.size()}; }
    // Contains all clusters: an aligned box.
    [[nodiscard]] const Cluster& bound() const { return bound_; }
    // Differs for each call of cut() and deserialise() of the process; copies share it. 0: the mesh is empty.
    [[nodiscard]] std::uint64_t identity() const { return identity_; }
    // Bytes that this object holds.
    [[nodiscard]] std::size_t memory() const;

    // Returns bytes from which deserialise() makes an equal object without cutting again, on machines of the same byte
    // order; their number is a multiple of 4.
    [[nodiscard]] Vector<std::byte> serialise() const;
    // Errors: bytes that are cut off, or whose numbers are out of range (parse; item = cluster). Make sure
    // that the bytes belong to this mesh and are undamaged: boxes are not compared with the triangles.
    [[nodiscard]] static Result<ClusteredMesh> deserialise(std::span<const std::byte> bytes);

    // A cluster, laid out for DepthCuller.
    struct Patch {
        std::uint32_t first_coordinate;  // x of all vertices, then y, then z, each padded to whole vectors
        std::uint32_t first_block;
        std::uint8_t vertex_count;  // equal positions count as one
        std::uint8_t triangle_count;
    };
    static constexpr std::uint32_t kLanes = 8;
    // Eight triangles of a patch; those beyond its last have three equal corners.
    struct Block {
        std::uint8_t corners[3][kLanes];  // vertices of the patch
        // The triangle across the edge from corner k to k + 1: 4 · triangle of the patch + its edge, or kNone.
        std::uint8_t neighbors[3][kLanes];
    };
    static constexpr std::uint8_t kNone = 0xff;
    struct Layout {
        std::span<const Patch> patches;  // one a cluster
        std::span<const float> coordinates;
        std::span<const Block> blocks;
        glm::vec3 largest;  // absolute coordinates
    };
    [[nodiscard]] Layout layout() const {
        // By pointer and size, as above: a conversion from a vector takes compilers longer than the rest of the class.
        return {{patches_.data(), patches_.size()},
                {coordinates_.data(), coordinates_.size()},
                {blocks_.data(), blocks_.size()},
                largest_};
    }

  private:
    friend class PatchBuilder;
    friend struct StoredMesh;
    [[nodiscard]] static std::uint64_t next_identity();
    Vector<std::uint32_t> order_;
    Vector<Cluster> clusters_;
    Cluster bound_;
    glm::vec3 largest_{0.0f};
    Vector<Patch> patches_;  // one a cluster
    Vector<float> coordinates_;
    Vector<Block> blocks_;
    ResetOnMove<std::uint64_t> identity_;
};

}  // namespace crofton::depth
