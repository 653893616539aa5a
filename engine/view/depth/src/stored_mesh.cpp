// SPDX-License-Identifier: MIT
// Serialises clusters, for files.
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/core/drop_spare.hpp>
#include <crofton/depth/clustered_mesh.hpp>
#include <cstring>
#include <numeric>
#include <utility>

#include "mesh_packer.hpp"
#include "oriented_bound.hpp"
#include "patch.hpp"

namespace crofton::depth {
namespace {

// What the bytes begin with. Then: the count of each cluster (ClusteredMesh::counts(), padded to whole words), a
// PackedBox each, the order of the triangles, their corners, the vertices.
struct StoredHeader {
    std::uint32_t clusters = 0, triangles = 0, corner_words = 0, vertices = 0;
    std::uint32_t corner_bits = 0;
    glm::vec3 largest{0.0f}, center{0.0f}, half{0.0f};
};
static_assert(sizeof(StoredHeader) == 56 && sizeof(ClusteredMesh::PackedBox) == 32 && sizeof(glm::vec3) == 12);

constexpr float kFarthest = 1e16f;  // of a box around positions up to 1e15
constexpr std::uint32_t kMostTriangles = std::uint32_t{1} << 28;

constexpr std::uint64_t whole_words(std::uint64_t bytes) {
    return (bytes + 3) / 4 * 4;
}

std::uint64_t size_for(const StoredHeader& header) {
    return sizeof header + whole_words(header.clusters) +
           std::uint64_t{header.clusters} * sizeof(ClusteredMesh::PackedBox) + std::uint64_t{header.triangles} * 4 +
           std::uint64_t{header.corner_words} * 4 + std::uint64_t{header.vertices} * sizeof(glm::vec3);
}

Error damaged(const char* what, std::uint64_t cluster = kNoItem) {
    return fail(ErrorCode::parse, cluster, {"clusters: ", what});
}

// Also false for NaN.
bool is_within(const glm::vec3& v, float limit) {
    return std::abs(v.x) <= limit && std::abs(v.y) <= limit && std::abs(v.z) <= limit;
}
bool is_extent(const glm::vec3& v) {
    return is_within(v, kFarthest) && std::min({v.x, v.y, v.z}) >= 0.0f;
}
bool is_box(const ClusterBox& box) {
    return is_within(box.center, kFarthest) && std::all_of(box.half_edges.begin(), box.half_edges.end(),
                                                           [](const glm::vec3& e) { return is_within(e, kFarthest); });
}

void append(Vector<std::byte>& bytes, const void* from, std::size_t size) {
    const auto* const begin = static_cast<const std::byte*>(from);
    bytes.insert(bytes.end(), begin, begin + size);
}

}  // namespace

struct StoredMesh {
    // Takes `count` elements from the front of the bytes.
    template <class T>
    static void take(std::span<const std::byte>& bytes, std::size_t count, Vector<T>& to) {
        to.resize(count);
        if (count > 0) std::memcpy(to.data(), bytes.data(), count * sizeof(T));
        bytes = bytes.subspan(count * sizeof(T));
    }

    static Result<void> check_order(std::span<const std::uint32_t> order) {
        Vector<bool> seen(order.size(), false);
        for (const std::uint32_t triangle : order) {
            if (triangle >= order.size() || seen[triangle]) return damaged("a triangle is not there once");
            seen[triangle] = true;
        }
        return {};
    }

    // Vertices follow one another as clusters do: their corners tell how many each has, and which have twins.
    static Result<void> check_clusters(ClusteredMesh& mesh) {
        const auto patch = Owner<Patch>::make();
        Vector<std::uint8_t> corners;
        std::size_t vertex = 0;
        for (std::size_t c = 0; c < mesh.cluster_count_; ++c) {
            if (!is_box(mesh.box_of(c))) return damaged("a cluster's box is none", c);
            mesh.own_->first_vertices.push_back(static_cast<std::uint32_t>(vertex));
            if (!PatchReader::read_corners(mesh, c, *patch))
                return damaged("a triangle names a vertex that its cluster does not have", c);
            const std::span<const glm::vec3> all = mesh.own_->vertices;
            if (patch->vertex_count > all.size() - vertex)
                return damaged("a cluster has more vertices than there are", c);
            if (!contains(mesh.boxes()[c], all.subspan(vertex, patch->vertex_count)))
                return damaged("a cluster's box does not contain its triangles", c);
            vertex += patch->vertex_count;
            corners.clear();
            for (std::uint32_t t = 0; t < patch->triangle_count; ++t)
                for (std::uint32_t k = 0; k < 3; ++k) corners.push_back(static_cast<std::uint8_t>(patch->corner(t, k)));
            MeshPacker::set_twins(const_cast<ClusteredMesh::PackedBox&>(mesh.boxes()[c]),
                                  MeshPacker::has_twins(corners));
        }
        if (vertex != mesh.own_->vertices.size()) return damaged("there are more vertices than clusters have");
        crofton::detail::drop_spare(mesh.own_->first_vertices);
        return {};
    }

    // Also refuses NaN.
    static bool are_within(std::span<const glm::vec3> vertices, const glm::vec3& largest) {
        return std::all_of(vertices.begin(), vertices.end(), [&](const glm::vec3& v) {
            return std::abs(v.x) <= largest.x && std::abs(v.y) <= largest.y && std::abs(v.z) <= largest.z;
        });
    }

    // Of what is lent in order, that order.
    static Vector<std::uint32_t> order_of(const ClusteredMesh& mesh) {
        if (mesh.own_) return mesh.own_->order;
        Vector<std::uint32_t> order(mesh.triangle_count_);
        std::iota(order.begin(), order.end(), 0u);
        return order;
    }

    static Vector<glm::vec3> vertices_of(const ClusteredMesh& mesh, Vector<std::uint32_t>& firsts) {
        Vector<glm::vec3> vertices;
        const auto patch = Owner<Patch>::make();
        for (std::size_t c = 0; c < mesh.cluster_count_; ++c) {
            PatchReader::read(mesh, c, *patch);
            firsts.push_back(static_cast<std::uint32_t>(vertices.size()));
            for (std::uint32_t v = 0; v < patch->vertex_count; ++v) vertices.push_back(patch->vertex(v));
        }
        return vertices;
    }
};

void ClusteredMesh::keep_copy() {
    if (lent_indices_ == nullptr) return;
    auto own = Owner<Own>::make();
    own->vertices = StoredMesh::vertices_of(*this, own->first_vertices);
    own->order = StoredMesh::order_of(*this);
    own_ = std::move(own);
    lent_positions_ = nullptr, lent_indices_ = nullptr;
}

Vector<std::byte> ClusteredMesh::serialise() const {
    Vector<std::uint32_t> first_vertices;
    const Vector<glm::vec3> vertices = StoredMesh::vertices_of(*this, first_vertices);
    const Vector<std::uint32_t> order = StoredMesh::order_of(*this);
    const StoredHeader header{
        cluster_count_, triangle_count_, corner_words_, static_cast<std::uint32_t>(vertices.size()),
        corner_bits_,   largest_,        bound_center_, bound_half_};
    Vector<std::byte> bytes;
    bytes.reserve(static_cast<std::size_t>(size_for(header)));
    append(bytes, &header, sizeof header);
    append(bytes, counts(), cluster_count_);
    bytes.resize(static_cast<std::size_t>(whole_words(bytes.size())));
    append(bytes, boxes().data(), boxes().size_bytes());
    append(bytes, order.data(), order.size() * sizeof(std::uint32_t));
    append(bytes, corner_words(), corner_words_ * sizeof(std::uint32_t));
    append(bytes, vertices.data(), vertices.size() * sizeof(glm::vec3));
    return bytes;
}

Result<ClusteredMesh> ClusteredMesh::deserialise(std::span<const std::byte> bytes) {
    StoredHeader header;
    if (bytes.size() < sizeof header) return damaged("the bytes are cut off");
    std::memcpy(&header, bytes.data(), sizeof header);
    if (bytes.size() != size_for(header)) return damaged("the bytes are not as many as their header says");
    if (header.clusters == 0 || header.triangles > kMostTriangles) return damaged("a count is out of range");
    // Of the widest cluster; others take up to 3 bits less.
    if (header.corner_bits < 1 || header.corner_bits > 8) return damaged("a corner's number of bits is out of range");
    if (!is_within(header.center, kFarthest) || !is_extent(header.half) || !is_extent(header.largest))
        return damaged("the mesh's box is none");
    bytes = bytes.subspan(sizeof header);
    ClusteredMesh mesh;
    mesh.largest_ = header.largest;
    mesh.bound_center_ = header.center, mesh.bound_half_ = header.half;
    mesh.triangle_count_ = header.triangles;
    mesh.corner_bits_ = header.corner_bits;
    mesh.own_ = Owner<Own>::make();
    Vector<std::uint8_t> counts;
    Vector<PackedBox> boxes;
    Vector<std::uint32_t> words;
    StoredMesh::take(bytes, static_cast<std::size_t>(whole_words(header.clusters)), counts);
    StoredMesh::take(bytes, header.clusters, boxes);
    StoredMesh::take(bytes, header.triangles, mesh.own_->order);
    StoredMesh::take(bytes, header.corner_words, words);
    StoredMesh::take(bytes, header.vertices, mesh.own_->vertices);
    counts.resize(header.clusters);
    for (std::size_t c = 0; c < counts.size(); ++c)
        if (counts[c] >> 6 >= header.corner_bits) return damaged("a corner's number of bits is out of range", c);
    if (!MeshPacker::set_lists(mesh, words, boxes, counts))
        return damaged("there are not as many triangles or corners as clusters have");
    if (auto checked = StoredMesh::check_order(mesh.own_->order); !checked) return checked.error();
    if (auto checked = StoredMesh::check_clusters(mesh); !checked) return checked.error();
    if (!StoredMesh::are_within(mesh.own_->vertices, mesh.largest_))
        return damaged("a coordinate is beyond the mesh's");
    if (!contains(mesh.bound(), mesh.own_->vertices)) return damaged("the mesh's box does not contain it");
    mesh.identity_ = next_identity();
    return mesh;
}

}  // namespace crofton::depth
