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
#include <utility>

#include "adjacency.hpp"
#include "cut.hpp"
#include "oriented_bound.hpp"
#include "patch.hpp"

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

// Writes the clusters of a mesh one after the other.
class PatchBuilder {
  public:
    PatchBuilder(ClusteredMesh& mesh, std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices)
        : mesh_(mesh), positions_(positions), indices_(indices), patch_(Owner<Patch>::make()) {}

    // Triangles [begin, end) of the order.
    void add(std::uint32_t begin, std::uint32_t end) {
        Vector<std::uint32_t>& order = mesh_.order_;
        // Ascending, so that what a cluster lists is drawn in the order of the mesh.
        std::sort(order.begin() + begin, order.begin() + end);
        own_.clear();
        for (std::uint32_t k = begin; k < end; ++k)
            for (std::uint32_t c = 0; c < 3; ++c) own_.push_back(indices_[std::size_t{3} * order[k] + c]);
        const auto first_vertex = static_cast<std::uint32_t>(mesh_.vertices_.size());
        weld();
        const auto vertices = static_cast<std::uint32_t>(mesh_.vertices_.size()) - first_vertex;
        mesh_.clusters_.push_back({begin, end - begin});
        mesh_.boxes_.push_back(bound_of(positions_, own_, vertices));
        mesh_.firsts_.push_back(static_cast<std::uint32_t>(mesh_.corners_.size()));
        mesh_.first_vertices_.push_back(first_vertex);
        append_corners(bits_for(vertices));
        mesh_.corners_.push_back(0);  // read with the last
        const std::size_t cluster = mesh_.clusters_.size() - 1;
        (void)PatchReader::read(mesh_, cluster, *patch_);
        PatchReader::note_twins(mesh_, cluster, *patch_);
        if (end != indices_.size() / 3) mesh_.corners_.pop_back();
    }

  private:
    // Numbers the cluster's vertices, equal positions alike.
    void weld() {
        numbers_.clear();
        std::uint32_t count = 0;
        for (std::size_t i = 0; i < own_.size(); ++i) {
            const glm::vec3& p = positions_[own_[i]];
            // + 0 makes −0 and 0 one number.
            const std::array<float, 3> place = {p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};
            const std::uint8_t number = numbers_.number_of(std::bit_cast<std::array<std::uint32_t, 3>>(place),
                                                           static_cast<std::uint8_t>(count));
            if (number == count) ++count, mesh_.vertices_.push_back(p);
            corners_[i] = number;
        }
    }

    void append_corners(std::uint32_t bits) {
        std::uint64_t word = 0;
        std::uint32_t filled = 0;
        for (std::size_t i = 0; i < own_.size(); ++i) {
            word |= std::uint64_t{corners_[i]} << filled;
            filled += bits;
            if (filled < 32) continue;
            mesh_.corners_.push_back(static_cast<std::uint32_t>(word));
            word >>= 32;
            filled -= 32;
        }
        if (filled != 0) mesh_.corners_.push_back(static_cast<std::uint32_t>(word));
    }

    ClusteredMesh& mesh_;
    std::span<const glm::vec3> positions_;
    std::span<const std::uint32_t> indices_;
    Owner<Patch> patch_;
    Vector<std::uint32_t> own_;  // indices of the cluster
    SmallTable<std::array<std::uint32_t, 3>> numbers_;
    std::array<std::uint8_t, 3 * Cluster::kMaxTriangles> corners_;
};

Result<ClusteredMesh> ClusteredMesh::cut(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                                         const ClusterOptions& options) {
    if (auto checked = check(positions, indices, options); !checked) return checked.error();
    const std::uint32_t most =
        options.max_triangles != 0 ? options.max_triangles : cluster_size_for(indices.size() / 3);
    ClusteredMesh mesh;
    Groups groups = cut_into_groups(positions, indices, most);
    mesh.order_ = std::move(groups.order);
    mesh.triangle_count_ = mesh.order_.size();
    for (const std::uint32_t i : indices) mesh.largest_ = (glm::max)(mesh.largest_, glm::abs(positions[i]));
    mesh.bound_ = aligned_bound_of(positions, indices);
    PatchBuilder builder(mesh, positions, indices);
    std::uint32_t begin = 0;
    for (const std::uint32_t end : groups.ends) builder.add(std::exchange(begin, end), end);
    const auto drop_spare = [](auto&... lists) { (crofton::detail::drop_spare(lists), ...); };
    drop_spare(mesh.clusters_, mesh.boxes_, mesh.firsts_, mesh.corners_, mesh.vertices_, mesh.first_vertices_);
    mesh.identity_ = next_identity();
    return mesh;
}

Result<void> ClusteredMesh::lend(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices) {
    if (indices.size() != 3 * triangle_count_)
        return fail(ErrorCode::invalid_argument, kNoItem, "clusters: what is lent has another number of triangles");
    for (std::size_t i = 0; i < indices.size(); ++i)
        if (indices[i] >= positions.size())
            return fail(ErrorCode::out_of_range, i, "clusters: an index of what is lent is out of range");
    const auto patch = Owner<Patch>::make();
    for (std::size_t c = 0; c < clusters_.size(); ++c) {
        (void)PatchReader::read(*this, c, *patch);
        for (std::uint32_t t = 0; t < clusters_[c].triangle_count; ++t)
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::size_t i = std::size_t{3} * (clusters_[c].first_triangle + t) + k;
                if (positions[indices[i]] != patch->vertex(patch->corner(t, k)))
                    return fail(ErrorCode::invalid_argument, i,
                                "clusters: what is lent has a corner elsewhere; lend the indices that permute() wrote");
            }
    }
    lent_positions_ = positions, lent_indices_ = indices;
    order_ = Vector<std::uint32_t>(), vertices_ = Vector<glm::vec3>(), first_vertices_ = Vector<std::uint32_t>();
    return {};
}

std::uint64_t ClusteredMesh::next_identity() {
    static std::atomic<std::uint64_t> meshes{0};
    return 1 + meshes.fetch_add(1, std::memory_order_relaxed);
}

void ClusteredMesh::permute(std::span<const std::uint32_t> indices, std::span<std::uint32_t> to) const {
    if (order_.empty()) std::copy(indices.begin(), indices.end(), to.begin());
    for (std::size_t k = 0; k < order_.size(); ++k)
        std::copy_n(indices.begin() + 3 * static_cast<std::ptrdiff_t>(order_[k]), 3,
                    to.begin() + 3 * static_cast<std::ptrdiff_t>(k));
}

std::size_t ClusteredMesh::memory() const {
    const auto bytes = [](const auto&... lists) { return ((lists.capacity() * sizeof(lists[0])) + ...); };
    return sizeof(*this) + bytes(order_, clusters_, boxes_, firsts_, corners_, vertices_, first_vertices_);
}

}  // namespace crofton::depth
