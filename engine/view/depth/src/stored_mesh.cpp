// SPDX-License-Identifier: MIT
// Serialises clusters, for files.
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/depth/clustered_mesh.hpp>
#include <cstring>

namespace crofton::depth {
namespace {

// What the bytes begin with. Then: a Cluster each, the vertex count of each (a byte, padded to whole words), the order
// of the triangles, the coordinates, the blocks.
struct StoredHeader {
    std::uint32_t clusters = 0, triangles = 0, coordinates = 0, blocks = 0;
    glm::vec3 largest{0.0f};
    glm::vec3 center{0.0f};  // of the bound
    std::array<glm::vec3, 3> half_edges{};
};
static_assert(sizeof(StoredHeader) == 76 && sizeof(Cluster) == 56 && sizeof(ClusteredMesh::Block) == 48);

constexpr float kFarthest = 1e16f;  // of a box around positions up to 1e15
constexpr std::uint32_t kMostTriangles = std::uint32_t{1} << 28;

constexpr std::uint64_t whole_words(std::uint64_t bytes) {
    return (bytes + 3) / 4 * 4;
}
constexpr std::uint32_t padded(std::uint32_t count) {
    return (count + ClusteredMesh::kLanes - 1) / ClusteredMesh::kLanes * ClusteredMesh::kLanes;
}

std::uint64_t size_for(const StoredHeader& header) {
    return sizeof header + std::uint64_t{header.clusters} * sizeof(Cluster) + whole_words(header.clusters) +
           std::uint64_t{header.triangles} * 4 + std::uint64_t{header.coordinates} * 4 +
           std::uint64_t{header.blocks} * sizeof(ClusteredMesh::Block);
}

Error damaged(const char* what, std::uint64_t cluster = kNoItem) {
    return fail(ErrorCode::parse, cluster, {"clusters: ", what});
}

// Also false for NaN.
bool is_within(const glm::vec3& v, float limit) {
    return std::abs(v.x) <= limit && std::abs(v.y) <= limit && std::abs(v.z) <= limit;
}
bool is_box(const glm::vec3& center, const std::array<glm::vec3, 3>& half_edges) {
    return is_within(center, kFarthest) && std::all_of(half_edges.begin(), half_edges.end(),
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

    // Patches follow one another in coordinates and blocks, so their sizes alone are stored.
    static Result<void> place_patches(ClusteredMesh& mesh, std::span<const std::uint8_t> vertex_counts) {
        std::uint64_t triangle = 0, coordinate = 0, block = 0;
        for (std::size_t c = 0; c < mesh.clusters_.size(); ++c) {
            const Cluster& cluster = mesh.clusters_[c];
            if (cluster.first_triangle != triangle || cluster.triangle_count < 1 ||
                cluster.triangle_count > Cluster::kMaxTriangles)
                return damaged("a cluster's triangles do not follow those before", c);
            if (vertex_counts[c] < 1 || vertex_counts[c] > 3 * cluster.triangle_count)
                return damaged("a cluster's vertex count is out of range", c);
            if (!is_box(cluster.center, cluster.half_edges)) return damaged("a cluster's box is none", c);
            mesh.patches_.push_back({static_cast<std::uint32_t>(coordinate), static_cast<std::uint32_t>(block),
                                     vertex_counts[c], static_cast<std::uint8_t>(cluster.triangle_count)});
            triangle += cluster.triangle_count;
            coordinate += 3 * padded(vertex_counts[c]);
            block += padded(cluster.triangle_count) / ClusteredMesh::kLanes;
            if (coordinate > mesh.coordinates_.size() || block > mesh.blocks_.size())
                return damaged("a cluster has more vertices or triangles than there are", c);
        }
        if (triangle != mesh.order_.size() || coordinate != mesh.coordinates_.size() || block != mesh.blocks_.size())
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

    static bool is_sound(const ClusteredMesh::Block& block, std::uint32_t lane, const ClusteredMesh::Patch& patch,
                         bool within) {
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint8_t neighbor = block.neighbors[k][lane];
            if (block.corners[k][lane] >= patch.vertex_count) return false;
            if (!within && (block.corners[k][lane] != block.corners[0][lane] || neighbor != ClusteredMesh::kNone))
                return false;
            if (neighbor != ClusteredMesh::kNone && (neighbor / 4 >= patch.triangle_count || neighbor % 4 > 2))
                return false;
        }
        return true;
    }

    static Result<void> check_blocks(const ClusteredMesh& mesh) {
        for (std::size_t p = 0; p < mesh.patches_.size(); ++p) {
            const ClusteredMesh::Patch& patch = mesh.patches_[p];
            for (std::uint32_t t = 0; t < padded(patch.triangle_count); ++t)
                if (!is_sound(mesh.blocks_[patch.first_block + t / ClusteredMesh::kLanes], t % ClusteredMesh::kLanes,
                              patch, t < patch.triangle_count))
                    return damaged("a triangle names a vertex or a neighbour that its cluster does not have", p);
        }
        return {};
    }

    // Also refuses NaN.
    static bool are_within(std::span<const float> coordinates, const glm::vec3& largest) {
        const float limit = std::max({largest.x, largest.y, largest.z});
        return std::all_of(coordinates.begin(), coordinates.end(), [limit](float x) { return std::abs(x) <= limit; });
    }
};

Vector<std::byte> ClusteredMesh::serialise() const {
    StoredHeader header{static_cast<std::uint32_t>(clusters_.size()),
                        static_cast<std::uint32_t>(order_.size()),
                        static_cast<std::uint32_t>(coordinates_.size()),
                        static_cast<std::uint32_t>(blocks_.size()),
                        largest_,
                        bound_.center,
                        bound_.half_edges};
    Vector<std::byte> bytes;
    bytes.reserve(static_cast<std::size_t>(size_for(header)));
    append(bytes, &header, sizeof header);
    append(bytes, clusters_.data(), clusters_.size() * sizeof(Cluster));
    for (const Patch& patch : patches_) bytes.push_back(std::byte{patch.vertex_count});
    bytes.resize(static_cast<std::size_t>(whole_words(bytes.size())));
    append(bytes, order_.data(), order_.size() * sizeof(std::uint32_t));
    append(bytes, coordinates_.data(), coordinates_.size() * sizeof(float));
    append(bytes, blocks_.data(), blocks_.size() * sizeof(Block));
    return bytes;
}

Result<ClusteredMesh> ClusteredMesh::deserialise(std::span<const std::byte> bytes) {
    StoredHeader header;
    if (bytes.size() < sizeof header) return damaged("the bytes are cut off");
    std::memcpy(&header, bytes.data(), sizeof header);
    if (bytes.size() != size_for(header)) return damaged("the bytes are not as many as their header says");
    if (header.clusters == 0 || header.triangles > kMostTriangles) return damaged("a count is out of range");
    if (!is_box(header.center, header.half_edges) || !is_within(header.largest, kFarthest) ||
        std::min({header.largest.x, header.largest.y, header.largest.z}) < 0.0f)
        return damaged("the mesh's box is none");
    bytes = bytes.subspan(sizeof header);
    ClusteredMesh mesh;
    mesh.largest_ = header.largest;
    mesh.bound_ = {0, header.triangles, header.center, header.half_edges};
    Vector<std::uint8_t> vertex_counts;
    StoredMesh::take(bytes, header.clusters, mesh.clusters_);
    StoredMesh::take(bytes, static_cast<std::size_t>(whole_words(header.clusters)), vertex_counts);
    StoredMesh::take(bytes, header.triangles, mesh.order_);
    StoredMesh::take(bytes, header.coordinates, mesh.coordinates_);
    StoredMesh::take(bytes, header.blocks, mesh.blocks_);
    mesh.patches_.reserve(header.clusters);
    if (auto placed = StoredMesh::place_patches(mesh, vertex_counts); !placed) return placed.error();
    if (auto checked = StoredMesh::check_order(mesh.order_); !checked) return checked.error();
    if (auto checked = StoredMesh::check_blocks(mesh); !checked) return checked.error();
    if (!StoredMesh::are_within(mesh.coordinates_, mesh.largest_)) return damaged("a coordinate is beyond the mesh's");
    mesh.identity_ = next_identity();
    return mesh;
}

}  // namespace crofton::depth
