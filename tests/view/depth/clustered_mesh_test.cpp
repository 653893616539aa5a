// SPDX-License-Identifier: MIT
#include <crofton/depth/clustered_mesh.hpp>
#include <crofton/depth/depth_culler.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "depth_scenes.hpp"

namespace crofton::testing {
namespace {

using depth::Cluster;
using depth::ClusteredMesh;

TEST_CASE("each triangle is in one cluster, whose box contains it") {
    oracle::NearMisses random(7);
    for (const std::uint32_t most : {1u, 2u, 7u, 16u, 64u}) {
        const TriangleMesh mesh = hills(30, 50.0f, 5.0f, random);
        const ClusteredMesh cut = ClusteredMesh::cut(mesh.positions, mesh.indices, {.max_triangles = most}).value();
        std::vector<int> seen(mesh.triangle_count(), 0);
        std::uint32_t next = 0;
        for (const Cluster& c : cut.clusters()) {
            CHECK(c.first_triangle == next);
            CHECK(c.triangle_count >= 1);
            CHECK(c.triangle_count <= most);
            next += c.triangle_count;
            glm::dmat3 edges(glm::dvec3(c.half_edges[0]), glm::dvec3(c.half_edges[1]), glm::dvec3(c.half_edges[2]));
            for (std::uint32_t k = c.first_triangle; k < next; ++k) {
                ++seen[cut.triangle_order()[k]];
                for (int i = 0; i < 3; ++i) {
                    const glm::dvec3 p(mesh.positions[mesh.indices[3 * cut.triangle_order()[k] + std::uint32_t(i)]]);
                    const glm::dvec3 t = glm::inverse(edges) * (p - glm::dvec3(c.center));
                    CHECK(std::max({std::abs(t.x), std::abs(t.y), std::abs(t.z)}) <= 1.0);
                }
            }
        }
        CHECK(next == mesh.triangle_count());
        CHECK(std::count(seen.begin(), seen.end(), 1) == std::ptrdiff_t(seen.size()));
    }
}

TEST_CASE("bad meshes are refused by name") {
    TriangleMesh mesh = cube_mesh();
    CHECK(ClusteredMesh::cut(mesh.positions, mesh.indices, {.max_triangles = 65}).error().code ==
          ErrorCode::invalid_argument);
    CHECK(ClusteredMesh::cut(mesh.positions, {}).error().code == ErrorCode::empty);
    mesh.indices.push_back(0);
    CHECK(ClusteredMesh::cut(mesh.positions, mesh.indices).error().code == ErrorCode::invalid_argument);
    mesh.indices.pop_back();
    mesh.indices[17] = 8;
    const auto out = ClusteredMesh::cut(mesh.positions, mesh.indices);
    CHECK(out.error().code == ErrorCode::out_of_range);
    CHECK(out.error().item == 17);
    mesh.indices[17] = 0;
    mesh.positions[3].y = std::numeric_limits<float>::quiet_NaN();
    const auto nan = ClusteredMesh::cut(mesh.positions, mesh.indices);
    CHECK(nan.error().code == ErrorCode::non_finite);
    CHECK(nan.error().item == 3);
}

TEST_CASE("many equal, repeated and flat triangles are cut as others are") {
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i < 3000; ++i) {
        mesh.positions.push_back(glm::vec3(float(i % 3), float(i % 2), 0.0f));
        mesh.indices.push_back(i % 7 == 0 ? 0 : i);
    }
    const ClusteredMesh cut = ClusteredMesh::cut(mesh.positions, mesh.indices).value();
    std::uint32_t sum = 0;
    for (const Cluster& c : cut.clusters()) sum += c.triangle_count;
    CHECK(sum == 1000);
}

// Every array of both, bit by bit.
bool same(const ClusteredMesh& a, const ClusteredMesh& b) {
    const auto equal = [](auto x, auto y) {
        return x.size() == y.size() && (x.empty() || std::memcmp(x.data(), y.data(), x.size_bytes()) == 0);
    };
    const auto equal_patches = [](const ClusteredMesh::Patch& x, const ClusteredMesh::Patch& y) {
        return x.first_coordinate == y.first_coordinate && x.first_block == y.first_block &&
               x.vertex_count == y.vertex_count && x.triangle_count == y.triangle_count;
    };
    const auto p = a.layout().patches, q = b.layout().patches;
    return equal(a.clusters(), b.clusters()) && equal(a.triangle_order(), b.triangle_order()) &&
           equal(std::span(&a.bound(), 1), std::span(&b.bound(), 1)) &&
           equal(a.layout().coordinates, b.layout().coordinates) && equal(a.layout().blocks, b.layout().blocks) &&
           a.layout().largest == b.layout().largest &&
           std::equal(p.begin(), p.end(), q.begin(), q.end(), equal_patches);
}

TEST_CASE("clusters come back from their bytes as they were, whatever the size of mesh and cluster") {
    oracle::NearMisses random(8);
    for (const std::uint32_t most : {1u, 3u, 8u, 9u, 17u, 64u})
        for (const std::uint32_t side : {1u, 2u, 5u, 30u}) {
            // Flat ones, too: all of one coordinate is 0.
            const TriangleMesh mesh = hills(side, 50.0f, most % 2 == 0 ? 5.0f : 0.0f, random);
            const ClusteredMesh cut = ClusteredMesh::cut(mesh.positions, mesh.indices, {.max_triangles = most}).value();
            const auto bytes = cut.serialise();
            CHECK(bytes.size() % 4 == 0);
            CHECK(same(cut, ClusteredMesh::deserialise(bytes).value()));
        }
}

TEST_CASE("bytes of clusters that are cut off or changed are refused or harmless, never followed out of the mesh") {
    oracle::NearMisses random(9);
    const TriangleMesh mesh = hills(4, 50.0f, 5.0f, random);
    const ClusteredMesh cut = ClusteredMesh::cut(mesh.positions, mesh.indices, {.max_triangles = 5}).value();
    const auto bytes = cut.serialise();
    for (std::size_t size = 0; size < bytes.size(); ++size)
        CHECK(ClusteredMesh::deserialise(std::span(bytes).first(size)).error().code == ErrorCode::parse);
    std::size_t refused = 0;
    depth::DepthCuller culler;
    for (std::size_t at = 0; at < bytes.size(); ++at)
        for (const unsigned flip : {0x01u, 0x80u, 0xffu}) {
            auto changed = bytes;
            changed[at] ^= std::byte(flip);
            const auto read = ClusteredMesh::deserialise(changed);
            if (!read) {
                CHECK(read.error().code == ErrorCode::parse);
                ++refused;
                continue;
            }
            // All that is in range may be drawn, though it be another picture.
            const depth::DepthObject object{&*read, glm::mat4(0.01f)};
            CHECK(culler.find_visible(std::span(&object, 1), {.width = 32, .height = 32}));
            Vector<std::uint32_t> permuted(mesh.indices.size());
            read->permute(mesh.indices, permuted);
        }
    // All of the header's counts, the clusters' ranges and the order.
    CHECK(refused > 3 * (16 + 8 * cut.clusters().size() + 4 * cut.triangle_order().size()));
}

}  // namespace
}  // namespace crofton::testing
