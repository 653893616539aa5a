// SPDX-License-Identifier: MIT
#include <crofton/depth/clustered_mesh.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <crofton/core/drop_spare.hpp>
#include <glm/common.hpp>
#include <string>

#include "adjacency.hpp"
#include "cut.hpp"
#include "oriented_bound.hpp"

namespace crofton::depth {
namespace {

constexpr std::size_t kMaxMeshTriangles = std::size_t{1} << 28;
constexpr float kMaxPosition = 1e15f;

std::uint32_t cluster_size_for(std::size_t triangles) {
    constexpr std::size_t kSmall = 1'000, kLarge = 10'000;
    if (triangles <= kSmall) return 16;
    if (triangles >= kLarge) return 64;
    return static_cast<std::uint32_t>(16 + 48 * (triangles - kSmall) / (kLarge - kSmall));
}

Result<void> check(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                   const ClusterOptions& options) {
    if (options.max_triangles > Cluster::kMaxTriangles)
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "clusters: max_triangles is " + std::to_string(options.max_triangles) + "; use 0 to 64");
    if (indices.size() % 3 != 0)
        return fail(ErrorCode::invalid_argument, indices.size(), "clusters: the index count is not a multiple of 3");
    if (indices.empty()) return fail(ErrorCode::empty, kNoItem, "clusters: the mesh has no triangles");
    if (indices.size() / 3 > kMaxMeshTriangles)
        return fail(ErrorCode::out_of_range, kNoItem, "clusters: more than 2^28 triangles; split the mesh");
    for (std::size_t v = 0; v < positions.size(); ++v)
        for (glm::length_t k = 0; k < 3; ++k)
            if (!(std::abs(positions[v][k]) <= kMaxPosition))
                return fail(ErrorCode::non_finite, v, "clusters: a position is not finite, or beyond 1e15");
    for (std::size_t i = 0; i < indices.size(); ++i)
        if (indices[i] >= positions.size())
            return fail(ErrorCode::out_of_range, i, "clusters: an index is out of range");
    return {};
}

}  // namespace

// Lays out the patches of a mesh whose clusters are known.
class PatchBuilder {
  public:
    PatchBuilder(ClusteredMesh& mesh, std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices)
        : mesh_(mesh), positions_(positions), indices_(indices) {
        mesh.patches_.reserve(mesh.clusters_.size());
    }

    void add(const Cluster& cluster) {
        weld(cluster);
        mesh_.patches_.push_back(
            {static_cast<std::uint32_t>(mesh_.coordinates_.size()), static_cast<std::uint32_t>(mesh_.blocks_.size()),
             static_cast<std::uint8_t>(vertex_count_), static_cast<std::uint8_t>(cluster.triangle_count)});
        find_neighbors(corners_.data(), cluster.triangle_count, neighbors_.data());
        append_blocks(cluster.triangle_count);
        append_vertices();
    }

  private:
    static constexpr std::uint32_t kLanes = ClusteredMesh::kLanes;

    // Numbers the cluster's vertices, equal positions alike.
    void weld(const Cluster& cluster) {
        vertices_.clear();
        vertex_count_ = 0;
        for (std::uint32_t k = 0; k < cluster.triangle_count; ++k)
            for (std::uint32_t c = 0; c < 3; ++c) {
                const glm::vec3& p =
                    positions_[indices_[std::size_t{3} * mesh_.order_[cluster.first_triangle + k] + c]];
                // + 0 makes −0 and 0 one number.
                const std::array<float, 3> place = {p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};
                const std::uint8_t number = vertices_.number_of(std::bit_cast<std::array<std::uint32_t, 3>>(place),
                                                                static_cast<std::uint8_t>(vertex_count_));
                if (number == vertex_count_) places_[vertex_count_++] = place;
                corners_[3 * k + c] = number;
            }
    }

    void append_blocks(std::uint32_t triangles) {
        for (std::uint32_t first = 0; first < triangles; first += kLanes) {
            ClusteredMesh::Block block{};
            for (std::uint32_t i = 0; i < kLanes; ++i)
                for (std::uint32_t k = 0; k < 3; ++k) {
                    const bool within = first + i < triangles;
                    block.corners[k][i] = within ? corners_[3 * (first + i) + k] : std::uint8_t{0};
                    block.neighbors[k][i] = within ? neighbors_[3 * (first + i) + k] : ClusteredMesh::kNone;
                }
            mesh_.blocks_.push_back(block);
        }
    }

    void append_vertices() {
        const std::uint32_t padded = (vertex_count_ + kLanes - 1) / kLanes * kLanes;
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (std::uint32_t v = 0; v < padded; ++v)
                mesh_.coordinates_.push_back(places_[std::min(v, vertex_count_ - 1)][axis]);
    }

    ClusteredMesh& mesh_;
    std::span<const glm::vec3> positions_;
    std::span<const std::uint32_t> indices_;
    SmallTable<std::array<std::uint32_t, 3>> vertices_;
    std::array<std::array<float, 3>, 3 * Cluster::kMaxTriangles> places_;
    std::uint32_t vertex_count_ = 0;
    std::array<std::uint8_t, 3 * Cluster::kMaxTriangles> corners_, neighbors_;
};

Result<ClusteredMesh> ClusteredMesh::cut(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                                         const ClusterOptions& options) {
    if (auto checked = check(positions, indices, options); !checked) return checked.error();
    const std::uint32_t most =
        options.max_triangles != 0 ? options.max_triangles : cluster_size_for(indices.size() / 3);
    ClusteredMesh mesh;
    Groups groups = cut_into_groups(positions, indices, most);
    mesh.order_ = std::move(groups.order);
    std::uint32_t begin = 0;
    Vector<std::uint32_t> own;
    for (const std::uint32_t end : groups.ends) {
        Cluster cluster{begin, end - begin};
        // Ascending, so that what a cluster lists is drawn in the order of the mesh.
        std::sort(mesh.order_.begin() + begin, mesh.order_.begin() + end);
        own.clear();
        for (std::uint32_t k = begin; k < end; ++k)
            for (std::uint32_t c = 0; c < 3; ++c) own.push_back(indices[std::size_t{3} * mesh.order_[k] + c]);
        set_bound(cluster, positions, own);
        mesh.clusters_.push_back(cluster);
        begin = end;
    }
    for (const std::uint32_t i : indices) mesh.largest_ = (glm::max)(mesh.largest_, glm::abs(positions[i]));
    mesh.bound_ = {0, static_cast<std::uint32_t>(indices.size() / 3)};
    set_aligned_bound(mesh.bound_, positions, indices);
    PatchBuilder builder(mesh, positions, indices);
    for (const Cluster& cluster : mesh.clusters_) builder.add(cluster);
    crofton::detail::drop_spare(mesh.clusters_);
    crofton::detail::drop_spare(mesh.coordinates_);
    crofton::detail::drop_spare(mesh.blocks_);
    mesh.identity_ = next_identity();
    return mesh;
}

std::uint64_t ClusteredMesh::next_identity() {
    static std::atomic<std::uint64_t> meshes{0};
    return 1 + meshes.fetch_add(1, std::memory_order_relaxed);
}

void ClusteredMesh::permute(std::span<const std::uint32_t> indices, std::span<std::uint32_t> to) const {
    for (std::size_t k = 0; k < order_.size(); ++k)
        std::copy_n(indices.begin() + 3 * static_cast<std::ptrdiff_t>(order_[k]), 3,
                    to.begin() + 3 * static_cast<std::ptrdiff_t>(k));
}

std::size_t ClusteredMesh::memory() const {
    const auto bytes = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
    return sizeof(*this) + bytes(order_) + bytes(clusters_) + bytes(patches_) + bytes(coordinates_) + bytes(blocks_);
}

}  // namespace crofton::depth
