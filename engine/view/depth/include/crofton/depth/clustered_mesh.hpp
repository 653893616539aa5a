// SPDX-License-Identifier: MIT
// Meshes cut into clusters: small groups of neighbouring triangles that a view lists or drops as one.
#pragma once
#include <array>
#include <bit>
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::depth {

// The triangles [first_triangle, first_triangle + triangle_count) of the permuted mesh.
struct Cluster {
    static constexpr std::uint32_t kMaxTriangles = 64;  // a set of its triangles fits into one 64-bit number

    std::uint32_t first_triangle = 0;
    std::uint32_t triangle_count = 0;
};

// Contains a cluster's triangles, in model coordinates: the parallelepiped with the corners center ± each of the three.
struct ClusterBox {
    glm::vec3 center{0.0f};
    std::array<glm::vec3, 3> half_edges{};
};

struct ClusterOptions {
    // 1 to Cluster::kMaxTriangles; 0 chooses: 16 for meshes of up to 1,000 triangles, 64 for those of 10,000 and more,
    // and between them in proportion.
    std::uint32_t max_triangles = 0;
};

// A mesh as DepthCuller reads it: its clusters, and which triangles share vertices. Copies the positions, until lend()
// makes it read the caller's; the caller's index buffer is permuted by triangle_order(), so that each cluster is one
// range of it.
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

    // Reads positions from the caller's arrays from now on, and drops its copies and the order of triangles: it then
    // needs a tenth to a fifth of the arrays' memory. `indices` are those of permute(), or name vertices at the same
    // places. The arrays must outlive this object and its copies, and stay as they are.
    //
    // Errors: an index out of range (item = index), or a corner elsewhere than in the mesh that was cut (item = index);
    // another number of indices. The object is then as it was.
    [[nodiscard]] Result<void> lend(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices);

    // Triangle k of the permuted mesh is triangle triangle_order()[k] of the mesh that was given. Empty after lend().
    [[nodiscard]] std::span<const std::uint32_t> triangle_order() const { return {order_.data(), order_.size()}; }
    // Writes the triangles of `indices`, three numbers each, in that order to `to`. Requires as many of both as were
    // cut. After lend(), what was lent is in order, and `to` becomes `indices`.
    void permute(std::span<const std::uint32_t> indices, std::span<std::uint32_t> to) const;

    [[nodiscard]] std::span<const Cluster> clusters() const { return {clusters_.data(), clusters_.size()}; }
    [[nodiscard]] std::size_t triangle_count() const { return triangle_count_; }
    [[nodiscard]] ClusterBox box_of(std::size_t cluster) const { return boxes_[cluster].unpacked(); }
    // Contains all clusters: an aligned box.
    [[nodiscard]] const ClusterBox& bound() const { return bound_; }
    [[nodiscard]] const glm::vec3& largest() const { return largest_; }  // absolute coordinates
    // Differs for each call of cut() and deserialise() of the process; copies share it. 0: the mesh is empty.
    [[nodiscard]] std::uint64_t identity() const { return identity_; }
    // Bytes that this object holds, without what was lent.
    [[nodiscard]] std::size_t memory() const;

    // Returns bytes from which deserialise() makes an equal object without cutting again, on machines of the same byte
    // order; their number is a multiple of 4.
    [[nodiscard]] Vector<std::byte> serialise() const;
    // Errors: bytes that are cut off, or whose numbers are out of range (parse; item = cluster). Make sure
    // that the bytes belong to this mesh and are undamaged: boxes are not compared with the triangles.
    [[nodiscard]] static Result<ClusteredMesh> deserialise(std::span<const std::byte> bytes);

    // A box whose half edges are integers, up to 2^15, times a power of two. It contains the triangles exactly.
    struct PackedBox {
        float center[3];
        // Two numbers each, the first in the low half: the nine coordinates of the half edges, then
        // 2^8 · vertices of the cluster + the bits of the power's exponent in float.
        std::uint32_t words[5];

        [[nodiscard]] ClusterBox unpacked() const {
            const float unit = std::bit_cast<float>((words[4] >> 16 & 0xff) << 23);
            ClusterBox box{{center[0], center[1], center[2]}, {}};
            for (std::size_t i = 0; i < 9; ++i) {
                const auto units = static_cast<std::int16_t>(words[i / 2] >> 16 * (i % 2) & 0xffff);
                box.half_edges[i / 3][static_cast<glm::length_t>(i % 3)] = static_cast<float>(units) * unit;
            }
            return box;
        }
        [[nodiscard]] std::uint32_t vertex_count() const { return words[4] >> 24; }  // equal positions count as one
    };

    [[nodiscard]] std::span<const PackedBox> boxes() const { return {boxes_.data(), boxes_.size()}; }

  private:
    friend class PatchBuilder;
    friend class PatchReader;
    friend struct StoredMesh;
    [[nodiscard]] static std::uint64_t next_identity();

    Vector<std::uint32_t> order_;
    Vector<Cluster> clusters_;
    std::size_t triangle_count_ = 0;
    ClusterBox bound_;
    glm::vec3 largest_{0.0f};
    Vector<PackedBox> boxes_;  // one a cluster
    // Where its corners begin, and whether two of its triangles share an edge in one direction (patch.hpp).
    Vector<std::uint32_t> firsts_;
    Vector<std::uint32_t> corners_;
    // Of one cluster after the other, with the first vertex of each; or those that are lent.
    Vector<glm::vec3> vertices_;
    Vector<std::uint32_t> first_vertices_;
    std::span<const glm::vec3> lent_positions_;
    std::span<const std::uint32_t> lent_indices_;
    ResetOnMove<std::uint64_t> identity_;
};

}  // namespace crofton::depth
