// SPDX-License-Identifier: MIT
#include <crofton/depth/clustered_mesh.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <crofton/core/drop_spare.hpp>
#include <glm/common.hpp>
#include <numeric>
#include <string>
#include <utility>

#include "adjacency.hpp"
#include "cut.hpp"
#include "mesh_packer.hpp"
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

// Writes the clusters of a mesh one after the other.
class PatchBuilder {
  public:
    PatchBuilder(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices)
        : positions_(positions), indices_(indices) {}

    Vector<std::uint32_t> order;
    Vector<glm::vec3> vertices;
    Vector<std::uint32_t> first_vertices;
    MeshPacker packer;

    // Triangles [begin, end) of the order. Returns the number of vertices.
    std::uint32_t add(std::uint32_t begin, std::uint32_t end) {
        // Ascending, so that what a cluster lists is drawn in the order of the mesh.
        std::sort(order.begin() + begin, order.begin() + end);
        own_.clear();
        for (std::uint32_t k = begin; k < end; ++k)
            for (std::uint32_t c = 0; c < 3; ++c) own_.push_back(indices_[std::size_t{3} * order[k] + c]);
        const std::uint32_t count = weld();
        packer.add(bound_of(positions_, own_), std::span(corners_).first(own_.size()), count);
        return count;
    }
    // Copies what the cluster added last needs until its mesh is lent.
    void copy_vertices(std::uint32_t count) {
        first_vertices.push_back(static_cast<std::uint32_t>(vertices.size()));
        vertices.insert(vertices.end(), welded_.begin(), welded_.begin() + count);
    }

  private:
    // Numbers the cluster's vertices, equal positions alike. Returns how many there are.
    std::uint32_t weld() {
        numbers_.clear();
        std::uint32_t count = 0;
        for (std::size_t i = 0; i < own_.size(); ++i) {
            const glm::vec3& p = positions_[own_[i]];
            // + 0 makes −0 and 0 one number.
            const std::array<float, 3> place = {p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};
            const std::uint8_t number = numbers_.number_of(std::bit_cast<std::array<std::uint32_t, 3>>(place),
                                                           static_cast<std::uint8_t>(count));
            if (number == count) welded_[count++] = p;
            corners_[i] = number;
        }
        return count;
    }

    std::span<const glm::vec3> positions_;
    std::span<const std::uint32_t> indices_;
    Vector<std::uint32_t> own_;  // indices of the cluster
    SmallTable<std::array<std::uint32_t, 3>> numbers_;
    std::array<std::uint8_t, 3 * Cluster::kMaxTriangles> corners_;
    std::array<glm::vec3, 3 * Cluster::kMaxTriangles> welded_;
};

}  // namespace

Result<ClusteredMesh> ClusteredMesh::cut(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                                         const ClusterOptions& options) {
    if (auto checked = check(positions, indices, options); !checked) return checked.error();
    const std::uint32_t most =
        options.max_triangles != 0 ? options.max_triangles : cluster_size_for(indices.size() / 3);
    Groups groups = cut_into_groups(positions, indices, most);
    return build(positions, indices, std::move(groups.order), groups.ends, false);
}

Result<void> ClusteredMesh::refit(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices) {
    return refit(positions, indices, false);
}

Result<void> ClusteredMesh::refit_lent(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices) {
    return refit(positions, indices, true);
}

Result<void> ClusteredMesh::refit(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                                  bool lent) {
    if (indices.size() != std::size_t{3} * triangle_count_)
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "clusters: the deformed mesh has another number of triangles");
    if (auto checked = check(positions, indices, {}); !checked) return checked;
    Vector<std::uint32_t> order(triangle_order().begin(), triangle_order().end()), ends;
    if (order.empty()) {
        order.resize(triangle_count_);
        std::iota(order.begin(), order.end(), 0u);
    }
    for (const Cluster cluster : clusters()) ends.push_back(cluster.first_triangle + cluster.triangle_count);
    *this = build(positions, indices, std::move(order), ends, lent);
    // Permuted indices need no order.
    if (lent && std::ranges::is_sorted(own_->order)) own_ = Owner<Own>();
    return {};
}

ClusteredMesh ClusteredMesh::build(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                                   Vector<std::uint32_t> order, std::span<const std::uint32_t> ends, bool lent) {
    ClusteredMesh mesh;
    PatchBuilder builder(positions, indices);
    builder.order = std::move(order);
    std::uint32_t begin = 0;
    for (const std::uint32_t end : ends) {
        const std::uint32_t count = builder.add(std::exchange(begin, end), end);
        if (!lent) builder.copy_vertices(count);
    }
    mesh.triangle_count_ = begin;
    builder.packer.pack(mesh);
    for (const std::uint32_t i : indices) mesh.largest_ = (glm::max)(mesh.largest_, glm::abs(positions[i]));
    set_bound(positions, indices, mesh.bound_center_, mesh.bound_half_);
    crofton::detail::drop_spare(builder.vertices);
    crofton::detail::drop_spare(builder.first_vertices);
    mesh.own_ =
        Owner<Own>::make(Own{std::move(builder.order), std::move(builder.vertices), std::move(builder.first_vertices)});
    if (lent) mesh.lent_positions_ = positions.data(), mesh.lent_indices_ = indices.data();
    mesh.identity_ = next_identity();
    return mesh;
}

ClusteredMesh::ClusteredMesh(const ClusteredMesh& other)
    : packed_(other.packed_),
      own_(other.own_ ? Owner<Own>::make(*other.own_) : Owner<Own>()),
      lent_positions_(other.lent_positions_),
      lent_indices_(other.lent_indices_),
      cluster_count_(other.cluster_count_),
      triangle_count_(other.triangle_count_),
      corner_words_(other.corner_words_),
      corner_bits_(other.corner_bits_),
      bound_center_(other.bound_center_),
      bound_half_(other.bound_half_),
      largest_(other.largest_),
      identity_(other.identity_) {}

ClusteredMesh& ClusteredMesh::operator=(const ClusteredMesh& other) {
    return *this = ClusteredMesh(other);
}

Result<void> ClusteredMesh::lend(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                                 IndexOrder order) {
    const bool keeps_order = order == IndexOrder::original;
    if (indices.size() != std::size_t{3} * triangle_count_)
        return fail(ErrorCode::invalid_argument, kNoItem, "clusters: what is lent has another number of triangles");
    if (keeps_order && triangle_order().size() != triangle_count_)
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "clusters: the order of triangles was dropped; lend the permuted indices");
    for (std::size_t i = 0; i < indices.size(); ++i)
        if (indices[i] >= positions.size())
            return fail(ErrorCode::out_of_range, i, "clusters: an index of what is lent is out of range");
    const auto patch = Owner<Patch>::make();
    std::size_t triangle = 0;
    for (std::size_t c = 0; c < cluster_count_; ++c) {
        PatchReader::read(*this, c, *patch);
        for (std::uint32_t t = 0; t < patch->triangle_count; ++t, ++triangle)
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::size_t i = std::size_t{3} * (keeps_order ? own_->order[triangle] : triangle) + k;
                if (positions[indices[i]] != patch->vertex(patch->corner(t, k)))
                    return fail(
                        ErrorCode::invalid_argument, i,
                        "clusters: what is lent has a corner elsewhere; lend the permuted indices, or the original "
                        "ones as such");
            }
    }
    if (keeps_order)
        own_->vertices = Vector<glm::vec3>(), own_->first_vertices = Vector<std::uint32_t>();
    else
        own_ = Owner<Own>();
    lent_positions_ = positions.data(), lent_indices_ = indices.data();
    return {};
}

std::uint64_t ClusteredMesh::next_identity() {
    static std::atomic<std::uint64_t> meshes{0};
    return 1 + meshes.fetch_add(1, std::memory_order_relaxed);
}

void ClusteredMesh::permute(std::span<const std::uint32_t> indices, std::span<std::uint32_t> to) const {
    const std::span<const std::uint32_t> order = triangle_order();
    if (order.empty()) std::copy(indices.begin(), indices.end(), to.begin());
    for (std::size_t k = 0; k < order.size(); ++k)
        std::copy_n(indices.begin() + 3 * static_cast<std::ptrdiff_t>(order[k]), 3,
                    to.begin() + 3 * static_cast<std::ptrdiff_t>(k));
}

std::size_t ClusteredMesh::memory() const {
    const auto bytes = [](const auto&... lists) { return ((lists.capacity() * sizeof(lists[0])) + ...); };
    return sizeof(*this) + bytes(packed_) +
           (own_ ? sizeof(Own) + bytes(own_->order, own_->vertices, own_->first_vertices) : 0);
}

}  // namespace crofton::depth
