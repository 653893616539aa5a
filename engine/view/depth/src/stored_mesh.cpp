// SPDX-License-Identifier: MIT
// Serialises clusters, for files.
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/core/drop_spare.hpp>
#include <crofton/depth/clustered_mesh.hpp>
#include <cstring>
#include <numeric>

#include "patch.hpp"

namespace crofton::depth {
namespace {

// What the bytes begin with. Then: the triangle count of each cluster (a byte, padded to whole words), a PackedBox
// each, the order of the triangles, their corners, the vertices.
struct StoredHeader {
    std::uint32_t clusters = 0, triangles = 0, corner_words = 0, vertices = 0;
    glm::vec3 largest{0.0f};
    ClusterBox bound;
};
static_assert(sizeof(StoredHeader) == 76 && sizeof(ClusteredMesh::PackedBox) == 32 && sizeof(glm::vec3) == 12);

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

    // Clusters follow one another in all lists, so their sizes alone are stored.
    static Result<void> place_clusters(ClusteredMesh& mesh, std::span<const std::uint8_t> triangle_counts) {
        std::uint64_t triangle = 0, word = 0, vertex = 0;
        for (std::size_t c = 0; c < mesh.boxes_.size(); ++c) {
            const std::uint32_t triangles = triangle_counts[c], vertices = mesh.boxes_[c].vertex_count();
            if (triangles < 1 || triangles > Cluster::kMaxTriangles)
                return damaged("a cluster's number of triangles is out of range", c);
            if (vertices < 1 || vertices > 3 * triangles) return damaged("a cluster's vertex count is out of range", c);
            if (!is_box(mesh.box_of(c))) return damaged("a cluster's box is none", c);
            mesh.clusters_.push_back({static_cast<std::uint32_t>(triangle), triangles});
            mesh.firsts_.push_back(static_cast<std::uint32_t>(word));
            mesh.first_vertices_.push_back(static_cast<std::uint32_t>(vertex));
            triangle += triangles;
            word += words_for(vertices, triangles);
            vertex += vertices;
            if (triangle > mesh.triangle_count_ || word > mesh.corners_.size() || vertex > mesh.vertices_.size())
                return damaged("a cluster has more vertices or triangles than there are", c);
        }
        // A word follows the last cluster's.
        if (triangle != mesh.triangle_count_ || word + 1 != mesh.corners_.size() || vertex != mesh.vertices_.size())
            return damaged("there are more vertices or triangles than clusters have");
        return {};
    }

    static Result<void> check_order(std::span<const std::uint32_t> order) {
        Vector<bool> seen(order.size(), false);
        for (const std::uint32_t triangle : order) {
            if (triangle >= order.size() || seen[triangle]) return damaged("a triangle is not there once");
            seen[triangle] = true;
        }
        return {};
    }

    static Result<void> check_corners(ClusteredMesh& mesh) {
        const auto patch = Owner<Patch>::make();
        for (std::size_t c = 0; c < mesh.clusters_.size(); ++c) {
            if (!PatchReader::read(mesh, c, *patch))
                return damaged("a triangle names a vertex that its cluster does not have", c);
            PatchReader::note_twins(mesh, c, *patch);
        }
        return {};
    }

    // Also refuses NaN.
    static bool are_within(std::span<const glm::vec3> vertices, const glm::vec3& largest) {
        const float limit = std::max({largest.x, largest.y, largest.z});
        return std::all_of(vertices.begin(), vertices.end(),
                           [limit](const glm::vec3& v) { return is_within(v, limit); });
    }

    static Vector<glm::vec3> vertices_of(const ClusteredMesh& mesh) {
        Vector<glm::vec3> vertices;
        const auto patch = Owner<Patch>::make();
        for (std::size_t c = 0; c < mesh.clusters_.size(); ++c) {
            (void)PatchReader::read(mesh, c, *patch);
            for (std::uint32_t v = 0; v < patch->vertex_count; ++v) vertices.push_back(patch->vertex(v));
        }
        return vertices;
    }
};

Vector<std::byte> ClusteredMesh::serialise() const {
    const Vector<glm::vec3> vertices = StoredMesh::vertices_of(*this);
    const StoredHeader header{static_cast<std::uint32_t>(clusters_.size()),
                              static_cast<std::uint32_t>(triangle_count_),
                              static_cast<std::uint32_t>(corners_.size()),
                              static_cast<std::uint32_t>(vertices.size()),
                              largest_,
                              bound_};
    Vector<std::uint32_t> in_order(order_.empty() ? triangle_count_ : 0);
    std::iota(in_order.begin(), in_order.end(), 0u);
    const std::span<const std::uint32_t> order = order_.empty() ? std::span(in_order) : triangle_order();
    Vector<std::byte> bytes;
    bytes.reserve(static_cast<std::size_t>(size_for(header)));
    append(bytes, &header, sizeof header);
    for (const Cluster& cluster : clusters_) bytes.push_back(static_cast<std::byte>(cluster.triangle_count));
    bytes.resize(static_cast<std::size_t>(whole_words(bytes.size())));
    append(bytes, boxes_.data(), boxes_.size() * sizeof(PackedBox));
    append(bytes, order.data(), order.size_bytes());
    append(bytes, corners_.data(), corners_.size() * sizeof(std::uint32_t));
    append(bytes, vertices.data(), vertices.size() * sizeof(glm::vec3));
    return bytes;
}

Result<ClusteredMesh> ClusteredMesh::deserialise(std::span<const std::byte> bytes) {
    StoredHeader header;
    if (bytes.size() < sizeof header) return damaged("the bytes are cut off");
    std::memcpy(&header, bytes.data(), sizeof header);
    if (bytes.size() != size_for(header)) return damaged("the bytes are not as many as their header says");
    if (header.clusters == 0 || header.triangles > kMostTriangles) return damaged("a count is out of range");
    if (!is_box(header.bound) || !is_within(header.largest, kFarthest) ||
        std::min({header.largest.x, header.largest.y, header.largest.z}) < 0.0f)
        return damaged("the mesh's box is none");
    bytes = bytes.subspan(sizeof header);
    ClusteredMesh mesh;
    mesh.largest_ = header.largest;
    mesh.bound_ = header.bound;
    mesh.triangle_count_ = header.triangles;
    Vector<std::uint8_t> triangle_counts;
    StoredMesh::take(bytes, static_cast<std::size_t>(whole_words(header.clusters)), triangle_counts);
    StoredMesh::take(bytes, header.clusters, mesh.boxes_);
    StoredMesh::take(bytes, header.triangles, mesh.order_);
    StoredMesh::take(bytes, header.corner_words, mesh.corners_);
    StoredMesh::take(bytes, header.vertices, mesh.vertices_);
    if (auto placed = StoredMesh::place_clusters(mesh, triangle_counts); !placed) return placed.error();
    if (auto checked = StoredMesh::check_order(mesh.order_); !checked) return checked.error();
    if (auto checked = StoredMesh::check_corners(mesh); !checked) return checked.error();
    if (!StoredMesh::are_within(mesh.vertices_, mesh.largest_)) return damaged("a coordinate is beyond the mesh's");
    for (auto* list : {&mesh.firsts_, &mesh.first_vertices_}) crofton::detail::drop_spare(*list);
    crofton::detail::drop_spare(mesh.clusters_);
    mesh.identity_ = next_identity();
    return mesh;
}

}  // namespace crofton::depth
