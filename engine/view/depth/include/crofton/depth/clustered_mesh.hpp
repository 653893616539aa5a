// SPDX-License-Identifier: MIT
// Meshes cut into clusters: small groups of neighbouring triangles that a view lists or drops as one.
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
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

// What DepthCuller reads of a mesh: its clusters, and which triangles meet along which edges. Copies the positions; the
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
    [[nodiscard]] std::span<const std::uint32_t> triangle_order() const { return order_; }
    // Writes the triangles of `indices`, three numbers each, in that order to `to`. Requires as many of both as were
    // cut.
    void permute(std::span<const std::uint32_t> indices, std::span<std::uint32_t> to) const;

    [[nodiscard]] std::span<const Cluster> clusters() const { return clusters_; }
    // Contains all clusters: an aligned box.
    [[nodiscard]] const Cluster& bound() const { return bound_; }
    // Bytes that this object holds.
    [[nodiscard]] std::size_t memory() const;

    // A cluster with the triangles around it, laid out for DepthCuller.
    struct Patch {
        std::uint32_t first_coordinate;  // x of all vertices, then y, then z, each padded to whole vectors
        std::uint32_t first_corner;      // three corners and three neighbours a triangle, own ones first
        std::uint32_t first_ring;        // the clusters of the triangles around, one each
        std::uint32_t first_vertex;      // into `enclosed`
        std::uint16_t vertex_count;
        std::uint16_t own_triangles, all_triangles;
    };
    struct Layout {
        std::span<const Patch> patches;  // one a cluster
        std::span<const float> coordinates;
        std::span<const std::uint16_t> corners;  // vertices of the patch
        std::span<const std::uint16_t>
            neighbors;  // across the edges corner k to k + 1: triangles of the patch, or kNone
        std::span<const std::uint32_t> ring_clusters;
        std::span<const std::uint8_t> enclosed;  // 1: all triangles around the vertex are the cluster's own
        glm::vec3 largest;                       // absolute coordinates
    };
    static constexpr std::uint16_t kNone = 0xffff;
    static constexpr std::uint32_t kLanes = 8;
    [[nodiscard]] Layout layout() const {
        return {patches_, coordinates_, corners_, neighbors_, ring_clusters_, enclosed_, largest_};
    }

  private:
    friend class PatchBuilder;
    Vector<std::uint32_t> order_;
    Vector<Cluster> clusters_;
    Cluster bound_;
    glm::vec3 largest_{0.0f};
    Vector<Patch> patches_;  // one a cluster
    Vector<float> coordinates_;
    Vector<std::uint16_t> corners_, neighbors_;
    Vector<std::uint32_t> ring_clusters_;
    Vector<std::uint8_t> enclosed_;
};

}  // namespace crofton::depth
