// SPDX-License-Identifier: MIT
#include <crofton/depth/clustered_mesh.hpp>

#include <algorithm>
#include <cmath>
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
        : mesh_(mesh), positions_(positions), adjacency_(find_adjacency(positions, indices)) {
        const std::size_t triangles = indices.size() / 3;
        cluster_of_.resize(triangles);
        for (std::uint32_t c = 0; c < mesh.clusters_.size(); ++c)
            for (std::uint32_t k = 0; k < mesh.clusters_[c].triangle_count; ++k)
                cluster_of_[mesh.order_[mesh.clusters_[c].first_triangle + k]] = c;
        local_triangle_.assign(triangles, ClusteredMesh::kNone);
        local_vertex_.assign(positions.size(), ClusteredMesh::kNone);
        mesh.patches_.reserve(mesh.clusters_.size());
    }

    void add(std::uint32_t cluster) {
        list_triangles(cluster);
        list_vertices();
        ClusteredMesh::Patch patch{static_cast<std::uint32_t>(mesh_.coordinates_.size()),
                                   static_cast<std::uint32_t>(mesh_.corners_.size()),
                                   static_cast<std::uint32_t>(mesh_.ring_clusters_.size()),
                                   static_cast<std::uint32_t>(mesh_.enclosed_.size()),
                                   static_cast<std::uint16_t>(vertices_.size()),
                                   static_cast<std::uint16_t>(own_),
                                   static_cast<std::uint16_t>(triangles_.size())};
        mesh_.patches_.push_back(patch);
        for (const std::uint32_t t : triangles_)
            for (std::uint32_t k = 0; k < 3; ++k) {
                mesh_.corners_.push_back(local_vertex_[adjacency_.corners[3 * t + k]]);
                const std::uint32_t other = adjacency_.neighbors[3 * t + k];
                mesh_.neighbors_.push_back(other == Adjacency::kNone ? ClusteredMesh::kNone : local_triangle_[other]);
            }
        for (std::size_t k = own_; k < triangles_.size(); ++k)
            mesh_.ring_clusters_.push_back(cluster_of_[triangles_[k]]);
        append_vertices();
        for (const std::uint32_t t : triangles_) local_triangle_[t] = ClusteredMesh::kNone;
        for (const std::uint32_t v : vertices_) local_vertex_[v] = ClusteredMesh::kNone;
    }

  private:
    void list_triangles(std::uint32_t cluster) {
        const Cluster& c = mesh_.clusters_[cluster];
        triangles_.assign(mesh_.order_.begin() + c.first_triangle,
                          mesh_.order_.begin() + c.first_triangle + c.triangle_count);
        own_ = triangles_.size();
        for (std::size_t k = 0; k < own_; ++k) local_triangle_[triangles_[k]] = static_cast<std::uint16_t>(k);
        for (std::size_t k = 0; k < own_; ++k)
            for (std::uint32_t e = 0; e < 3; ++e) {
                const std::uint32_t other = adjacency_.neighbors[3 * triangles_[k] + e];
                if (other == Adjacency::kNone || local_triangle_[other] != ClusteredMesh::kNone) continue;
                local_triangle_[other] = static_cast<std::uint16_t>(triangles_.size());
                triangles_.push_back(other);
            }
    }

    void list_vertices() {
        vertices_.clear();
        own_fans_.clear();
        for (std::size_t k = 0; k < triangles_.size(); ++k) {
            const std::uint32_t* c = adjacency_.corners.data() + 3 * triangles_[k];
            const bool counts = k < own_ && c[0] != c[1] && c[1] != c[2] && c[2] != c[0];
            for (std::uint32_t e = 0; e < 3; ++e) {
                std::uint16_t& local = local_vertex_[c[e]];
                if (local == ClusteredMesh::kNone) {
                    local = static_cast<std::uint16_t>(vertices_.size());
                    vertices_.push_back(c[e]);
                    own_fans_.push_back(0);
                }
                own_fans_[local] += counts;
            }
        }
    }

    void append_vertices() {
        const std::size_t padded =
            (vertices_.size() + ClusteredMesh::kLanes - 1) / ClusteredMesh::kLanes * ClusteredMesh::kLanes;
        for (glm::length_t axis = 0; axis < 3; ++axis)
            for (std::size_t v = 0; v < padded; ++v)
                mesh_.coordinates_.push_back(positions_[vertices_[std::min(v, vertices_.size() - 1)]][axis]);
        for (std::size_t v = 0; v < vertices_.size(); ++v)
            mesh_.enclosed_.push_back(adjacency_.open[vertices_[v]] == 0 &&
                                      own_fans_[v] == adjacency_.fans[vertices_[v]]);
    }

    ClusteredMesh& mesh_;
    std::span<const glm::vec3> positions_;
    Adjacency adjacency_;
    Vector<std::uint32_t> cluster_of_;      // by triangle
    Vector<std::uint16_t> local_triangle_;  // of the patch at hand
    Vector<std::uint16_t> local_vertex_;
    Vector<std::uint32_t> triangles_, vertices_, own_fans_;
    std::size_t own_ = 0;
};

Result<ClusteredMesh> ClusteredMesh::cut(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                                         const ClusterOptions& options) {
    if (auto checked = check(positions, indices, options); !checked) return tl::unexpected(checked.error());
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
    Vector<glm::vec3> used;
    used.reserve(indices.size());
    for (const std::uint32_t i : indices) {
        used.push_back(positions[i]);
        mesh.largest_ = (glm::max)(mesh.largest_, glm::abs(positions[i]));
    }
    mesh.bound_ = {0, static_cast<std::uint32_t>(indices.size() / 3)};
    set_aligned_bound(mesh.bound_, used);
    PatchBuilder builder(mesh, positions, indices);
    for (std::uint32_t c = 0; c < mesh.clusters_.size(); ++c) builder.add(c);
    return mesh;
}

void ClusteredMesh::permute(std::span<const std::uint32_t> indices, std::span<std::uint32_t> to) const {
    for (std::size_t k = 0; k < order_.size(); ++k)
        std::copy_n(indices.begin() + 3 * static_cast<std::ptrdiff_t>(order_[k]), 3,
                    to.begin() + 3 * static_cast<std::ptrdiff_t>(k));
}

std::size_t ClusteredMesh::memory() const {
    const auto bytes = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
    return sizeof(*this) + bytes(order_) + bytes(clusters_) + bytes(patches_) + bytes(coordinates_) + bytes(corners_) +
           bytes(neighbors_) + bytes(ring_clusters_) + bytes(enclosed_);
}

}  // namespace crofton::depth
