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
#include <iterator>
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

// In which order indices that are lent have the triangles.
enum class IndexOrder : std::uint8_t {
    permuted,  // as ClusteredMesh::permute() writes them
    original,  // as the mesh that was cut has them
};

// A mesh as DepthCuller reads it: its clusters, and which triangles share vertices. Copies the positions, until lend()
// makes it read the caller's; the caller's index buffer is permuted by triangle_order(), so that each cluster is one
// range of it.
class ClusteredMesh {
  public:
    ClusteredMesh() = default;
    ClusteredMesh(const ClusteredMesh& other);
    ClusteredMesh& operator=(const ClusteredMesh& other);
    ClusteredMesh(ClusteredMesh&&) noexcept = default;
    ClusteredMesh& operator=(ClusteredMesh&&) noexcept = default;
    ~ClusteredMesh() = default;

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

    // Takes the positions that the mesh has deformed into. Its triangles, their order and the clusters stay; their
    // boxes and shared vertices are found anew, and positions that were lent are lent no more. Takes a fifth of the
    // time of cut(). Far from the mesh that was cut, clusters may be large, and views then list more of them.
    //
    // Pass the indices of the mesh that was cut, or, if the order was dropped, the permuted ones. Errors: as cut();
    // another number of indices (invalid_argument). The object is then as it was.
    [[nodiscard]] Result<void> refit(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices);
    // Calls refit(), and reads the arrays in place from then on, as after lend(): without copying positions and
    // comparing each corner. The order of triangles is dropped if `indices` have it already.
    [[nodiscard]] Result<void> refit_lent(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices);

    // Reads positions from the caller's arrays from now on, and drops its copies: it then needs a tenth to a seventh of
    // the arrays' memory. The arrays must outlive this object and its copies, and stay as they are: a change of them is
    // not noticed, and views are then wrong. With permuted indices, or such that name vertices at the same places, the
    // order of triangles is dropped, too; with the original ones it is kept.
    //
    // Errors: an index out of range (item = index), or a corner elsewhere than in the mesh that was cut (item = index);
    // another number of indices; original indices after the order was dropped. The object is then as it was.
    [[nodiscard]] Result<void> lend(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                                    IndexOrder order = IndexOrder::permuted);

    // Copies the positions that are lent, which are then not read any more. Call it before they change or go.
    void keep_copy();

    // Triangle k of the permuted mesh is triangle triangle_order()[k] of the mesh that was given. Empty after
    // permuted indices were lent.
    [[nodiscard]] std::span<const std::uint32_t> triangle_order() const {
        return own_ ? std::span<const std::uint32_t>(own_->order) : std::span<const std::uint32_t>();
    }
    // Writes the triangles of `indices`, three numbers each, in that order to `to`. Requires as many of both as were
    // cut. Without an order, `to` becomes `indices`.
    void permute(std::span<const std::uint32_t> indices, std::span<std::uint32_t> to) const;

    // The ranges of the clusters, in their order. Each is found when it is asked for, from those of up to 15 others.
    class Clusters {
      public:
        [[nodiscard]] std::size_t size() const { return mesh_->cluster_count_; }
        [[nodiscard]] bool empty() const { return size() == 0; }
        [[nodiscard]] Cluster operator[](std::size_t cluster) const {
            const Place place = mesh_->place_of(cluster);
            return {place.first_triangle, mesh_->triangles_of(cluster)};
        }

        class Iterator {
          public:
            using iterator_category = std::input_iterator_tag;
            using value_type = Cluster;
            using difference_type = std::ptrdiff_t;
            using pointer = void;
            using reference = Cluster;
            Iterator(const ClusteredMesh* mesh, std::size_t at) : mesh_(mesh), at_(at) {}
            [[nodiscard]] Cluster operator*() const { return mesh_->clusters()[at_]; }
            Iterator& operator++() {
                ++at_;
                return *this;
            }
            [[nodiscard]] bool operator==(const Iterator& other) const { return at_ == other.at_; }

          private:
            const ClusteredMesh* mesh_;
            std::size_t at_;
        };
        [[nodiscard]] Iterator begin() const { return {mesh_, 0}; }
        [[nodiscard]] Iterator end() const { return {mesh_, size()}; }

      private:
        friend class ClusteredMesh;
        explicit Clusters(const ClusteredMesh* mesh) : mesh_(mesh) {}
        const ClusteredMesh* mesh_;
    };
    [[nodiscard]] Clusters clusters() const { return Clusters(this); }
    // Returns how many triangles a cluster has.
    [[nodiscard]] std::uint32_t triangles_of(std::size_t cluster) const { return (counts()[cluster] & 63u) + 1; }
    [[nodiscard]] std::size_t triangle_count() const { return triangle_count_; }
    [[nodiscard]] ClusterBox box_of(std::size_t cluster) const { return boxes()[cluster].unpacked(); }
    // Contains all clusters: an aligned box.
    [[nodiscard]] ClusterBox bound() const {
        return {bound_center_, {glm::vec3(bound_half_.x, 0, 0), {0, bound_half_.y, 0}, {0, 0, bound_half_.z}}};
    }
    [[nodiscard]] const glm::vec3& largest() const { return largest_; }  // absolute coordinates
    // Differs for each call of cut(), refit() and deserialise() of the process; copies share it. 0: the mesh is empty.
    [[nodiscard]] std::uint64_t identity() const { return identity_; }
    // Bytes that this object holds, without what was lent.
    [[nodiscard]] std::size_t memory() const;

    // Returns bytes from which deserialise() makes an equal object without cutting again, on machines of the same byte
    // order; their number is a multiple of 4.
    [[nodiscard]] Vector<std::byte> serialise() const;
    // Errors: bytes that are cut off, whose numbers are out of range, or with a box that does not contain its triangles
    // (parse; item = cluster). lend() finds out whether the bytes belong to a mesh.
    [[nodiscard]] static Result<ClusteredMesh> deserialise(std::span<const std::byte> bytes);

    // A box whose half edges are integers, up to 2^15, times a power of two. It contains the triangles exactly.
    struct PackedBox {
        float center[3];
        // Two numbers each, the first in the low half: the nine coordinates of the half edges, then the bits of the
        // power's exponent in float + 2^8 if the cluster has twins: two of its triangles have an edge in the same
        // direction, or a triangle has equal corners.
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
        [[nodiscard]] bool has_twins() const { return (words[4] >> 24 & 1) != 0; }
    };

    [[nodiscard]] std::span<const PackedBox> boxes() const {
        return {reinterpret_cast<const PackedBox*>(packed_.data() + std::size_t{4} * corner_words_), cluster_count_};
    }

  private:
    friend class MeshPacker;
    friend class PatchReader;
    friend struct StoredMesh;

    // Holds the copies that a mesh needs until arrays are lent; `order` stays if the lent indices are the original
    // ones.
    struct Own {
        Vector<std::uint32_t> order;
        Vector<glm::vec3> vertices;  // of one cluster after the other
        Vector<std::uint32_t> first_vertices;
    };
    // Says where every 16th cluster begins. The first cluster, which begins at 0, has none.
    struct Group {
        std::uint32_t first_triangle, first_word;
    };
    struct Place {
        std::uint32_t first_triangle, first_word;
        std::uint32_t first_bit;  // of its corners, from that word
    };
    static constexpr std::size_t kGroup = 16;

    // Triangles in their order, and where each cluster ends. `lent`: reads the arrays in place.
    [[nodiscard]] static ClusteredMesh build(std::span<const glm::vec3> positions,
                                             std::span<const std::uint32_t> indices, Vector<std::uint32_t> order,
                                             std::span<const std::uint32_t> ends, bool lent);
    [[nodiscard]] Result<void> refit(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                                     bool lent);
    [[nodiscard]] static std::uint64_t next_identity();
    [[nodiscard]] std::size_t group_count() const { return cluster_count_ == 0 ? 0 : (cluster_count_ - 1) / kGroup; }
    [[nodiscard]] const Group* groups() const {
        return reinterpret_cast<const Group*>(boxes().data() + cluster_count_);
    }
    // Holds a byte for each cluster: its triangles − 1, and in the two highest bits how many bits fewer a corner takes
    // than in the widest cluster.
    [[nodiscard]] const std::uint8_t* counts() const {
        return reinterpret_cast<const std::uint8_t*>(groups() + group_count());
    }
    [[nodiscard]] std::uint32_t bits_of(std::size_t cluster) const { return corner_bits_ - (counts()[cluster] >> 6); }
    [[nodiscard]] const std::uint32_t* corner_words() const {
        return reinterpret_cast<const std::uint32_t*>(packed_.data());
    }
    [[nodiscard]] Place place_of(std::size_t cluster) const {
        Place place{};
        const std::size_t group = cluster / kGroup;
        if (group != 0) place = {groups()[group - 1].first_triangle, groups()[group - 1].first_word, 0};
        for (std::size_t c = group * kGroup; c < cluster; ++c) {
            place.first_triangle += triangles_of(c);
            place.first_bit += 3 * triangles_of(c) * bits_of(c);
        }
        return place;
    }

    // The words of the corners, the boxes, groups and counts. Kernels read up to a box's size beyond the corners.
    Vector<std::byte> packed_;
    Owner<Own> own_;
    const glm::vec3* lent_positions_ = nullptr;
    const std::uint32_t* lent_indices_ = nullptr;
    ResetOnMove<std::uint32_t> cluster_count_, triangle_count_, corner_words_;
    std::uint32_t corner_bits_ = 1;  // of the clusters' corners, the most
    glm::vec3 bound_center_{0.0f}, bound_half_{0.0f};
    glm::vec3 largest_{0.0f};
    ResetOnMove<std::uint64_t> identity_;
};

}  // namespace crofton::depth
