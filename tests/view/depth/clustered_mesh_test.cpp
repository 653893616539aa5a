// SPDX-License-Identifier: MIT
#include <crofton/depth/clustered_mesh.hpp>
#include <crofton/depth/depth_culler.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "depth_scenes.hpp"
#include "owner_check.hpp"

namespace crofton::testing {
namespace {

using depth::Cluster;
using depth::ClusterBox;
using depth::ClusteredMesh;

TEST_CASE("each triangle is in one cluster, whose box contains it") {
    oracle::NearMisses random(7);
    for (const std::uint32_t most : {1u, 2u, 7u, 16u, 64u}) {
        const TriangleMesh mesh = hills(30, 50.0f, 5.0f, random);
        const ClusteredMesh cut = ClusteredMesh::cut(mesh.positions, mesh.indices, {.max_triangles = most}).value();
        std::vector<int> seen(mesh.triangle_count(), 0);
        std::uint32_t next = 0;
        for (std::size_t number = 0; number < cut.clusters().size(); ++number) {
            const Cluster& c = cut.clusters()[number];
            const ClusterBox box = cut.box_of(number);
            CHECK(c.first_triangle == next);
            CHECK(c.triangle_count >= 1);
            CHECK(c.triangle_count <= most);
            next += c.triangle_count;
            glm::dmat3 edges(glm::dvec3(box.half_edges[0]), glm::dvec3(box.half_edges[1]),
                             glm::dvec3(box.half_edges[2]));
            for (std::uint32_t k = c.first_triangle; k < next; ++k) {
                ++seen[cut.triangle_order()[k]];
                for (int i = 0; i < 3; ++i) {
                    const glm::dvec3 p(mesh.positions[mesh.indices[3 * cut.triangle_order()[k] + std::uint32_t(i)]]);
                    const glm::dvec3 t = glm::inverse(edges) * (p - glm::dvec3(box.center));
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
    for (std::size_t c = 0; c < std::min(a.clusters().size(), b.clusters().size()); ++c) {
        const Cluster x = a.clusters()[c], y = b.clusters()[c];
        if (x.first_triangle != y.first_triangle || x.triangle_count != y.triangle_count) return false;
    }
    const depth::ClusterBox x = a.bound(), y = b.bound();
    return a.clusters().size() == b.clusters().size() && equal(a.triangle_order(), b.triangle_order()) &&
           equal(std::span(&x, 1), std::span(&y, 1)) && equal(a.boxes(), b.boxes()) && a.largest() == b.largest() &&
           a.serialise() == b.serialise();
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

// Waves run over the mesh; some of its vertices meet, and others part.
TriangleMesh deformed(const TriangleMesh& mesh, float time) {
    TriangleMesh result = mesh;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        glm::vec3& p = result.positions[i];
        p += glm::vec3(3.0f * std::sin(0.2f * p.z + time), 2.0f * std::sin(0.3f * p.x + time), 0.0f);
        if (i % 11 == 3) p = result.positions[i - 1];
    }
    return result;
}

TEST_CASE("a mesh that deforms keeps its clusters and their order, and their boxes follow") {
    oracle::NearMisses random(9);
    for (const std::uint32_t most : {1u, 7u, 64u}) {
        const TriangleMesh mesh = hills(30, 50.0f, 5.0f, random);
        const ClusteredMesh before = ClusteredMesh::cut(mesh.positions, mesh.indices, {.max_triangles = most}).value();
        ClusteredMesh cut = before;
        for (int step = 1; step <= 5; ++step) {
            const TriangleMesh now = deformed(mesh, 0.7f * static_cast<float>(step));
            if (step == 3) REQUIRE(cut.lend(deformed(mesh, 1.4f).positions, now.indices, depth::IndexOrder::original));
            const std::uint64_t identity = cut.identity();
            REQUIRE(cut.refit(now.positions, now.indices));
            CHECK(cut.identity() != identity);
            CHECK(std::ranges::equal(cut.triangle_order(), before.triangle_order()));
            REQUIRE(cut.clusters().size() == before.clusters().size());
            for (std::size_t c = 0; c < cut.clusters().size(); ++c) {
                const Cluster x = cut.clusters()[c], y = before.clusters()[c];
                CHECK(x.first_triangle == y.first_triangle);
                CHECK(x.triangle_count == y.triangle_count);
                const ClusterBox box = cut.box_of(c);
                const glm::dmat3 edges(glm::dvec3(box.half_edges[0]), glm::dvec3(box.half_edges[1]),
                                       glm::dvec3(box.half_edges[2]));
                for (std::uint32_t k = x.first_triangle; k < x.first_triangle + x.triangle_count; ++k)
                    for (std::uint32_t i = 0; i < 3; ++i) {
                        const glm::vec3& p = now.positions[now.indices[3 * cut.triangle_order()[k] + i]];
                        const glm::dvec3 at = glm::inverse(edges) * (glm::dvec3(p) - glm::dvec3(box.center));
                        for (glm::length_t axis = 0; axis < 3; ++axis) CHECK(std::abs(at[axis]) <= 1.0 + 1e-9);
                    }
            }
            // Every corner is where it is told to be.
            CHECK(ClusteredMesh(cut).lend(now.positions, now.indices, depth::IndexOrder::original));
        }
        // Back where it was, it is the mesh that was cut.
        REQUIRE(cut.refit(mesh.positions, mesh.indices));
        CHECK(same(cut, before));
    }
}

TEST_CASE("a refit that reads in place is a refit and then a loan") {
    oracle::NearMisses random(14);
    const TriangleMesh mesh = hills(30, 50.0f, 5.0f, random), now = deformed(mesh, 1.1f);
    for (const bool keeps_order : {false, true}) {
        ClusteredMesh cut = ClusteredMesh::cut(mesh.positions, mesh.indices).value();
        auto indices = now.indices;
        const auto order = keeps_order ? depth::IndexOrder::original : depth::IndexOrder::permuted;
        if (!keeps_order) {
            cut.permute(now.indices, indices);
            REQUIRE(cut.lend(mesh.positions, indices));
            cut.keep_copy();
        }
        ClusteredMesh expected = cut;
        REQUIRE(expected.refit(now.positions, indices));
        REQUIRE(expected.lend(now.positions, indices, order));
        const std::uint64_t identity = cut.identity();
        REQUIRE(cut.refit_lent(now.positions, indices));
        CHECK(cut.identity() != identity);
        CHECK(cut.memory() == expected.memory());
        CHECK(std::ranges::equal(cut.triangle_order(), expected.triangle_order()));
        CHECK(same(cut, expected));
        // It reads the arrays that it was given.
        auto moved = now.positions;
        REQUIRE(cut.refit_lent(moved, indices));
        moved.assign(moved.size(), glm::vec3(0.0f));
        CHECK_FALSE(ClusteredMesh(cut).lend(now.positions, indices, order));
        TriangleMesh bad = now;
        bad.positions[7].x = std::numeric_limits<float>::quiet_NaN();
        CHECK(expected.refit_lent(bad.positions, indices).error().item == 7);
        CHECK(ClusteredMesh(expected).lend(now.positions, indices, order));
    }
}

TEST_CASE("of a mesh that has deformed all triangles that own a sample are listed") {
    oracle::NearMisses random(10);
    depth::DepthCuller culler;
    Checked all;
    for (int step = 0; step < 12; ++step) {
        Scene scene;
        const TriangleMesh mesh = hills(20, 50.0f, 5.0f, random);
        CutMesh& cut = scene.meshes.emplace_back(mesh, 0, false);
        if (step % 2 == 0) cut.clusters.lend(cut.mesh.positions, cut.mesh.indices).value();  // without its order
        const TriangleMesh now = deformed(cut.mesh, static_cast<float>(step));
        cut.clusters.refit(now.positions, step % 2 == 0 ? now.indices : mesh.indices).value();
        cut.mesh = now;
        scene.objects.push_back({&cut, glm::dmat4(1.0)});
        const Camera camera{.position = {90.0 * std::cos(step), 25.0, 90.0 * std::sin(step)},
                            .forward = {-std::cos(step), -0.2, -std::sin(step)}};
        const Checked checked = check(scene, camera, 120, 80, static_cast<std::uint64_t>(step), culler);
        all.lost += checked.lost;
        all.owners += checked.owners;
        all.listed += checked.listed;
        all.total += checked.total;
    }
    CHECK(all.lost == 0);
    CHECK(all.owners > 1000);
    CHECK(all.listed < all.total);
}

TEST_CASE("a deformed mesh that cannot be taken is refused, and the clusters stay as they were") {
    oracle::NearMisses random(11);
    const TriangleMesh mesh = hills(5, 50.0f, 5.0f, random);
    const ClusteredMesh before = ClusteredMesh::cut(mesh.positions, mesh.indices).value();
    ClusteredMesh cut = before;
    TriangleMesh bad = mesh;
    bad.positions[7].x = std::numeric_limits<float>::quiet_NaN();
    const auto nan = cut.refit(bad.positions, bad.indices);
    CHECK(nan.error().code == ErrorCode::non_finite);
    CHECK(nan.error().item == 7);
    bad = mesh;
    bad.indices.resize(bad.indices.size() - 3);
    CHECK(cut.refit(bad.positions, bad.indices).error().code == ErrorCode::invalid_argument);
    bad = mesh;
    bad.indices[5] = static_cast<std::uint32_t>(mesh.positions.size());
    CHECK(cut.refit(bad.positions, bad.indices).error().item == 5);
    CHECK(ClusteredMesh().refit(mesh.positions, mesh.indices).error().code == ErrorCode::invalid_argument);
    CHECK(ClusteredMesh().refit({}, {}).error().code == ErrorCode::empty);
    CHECK(same(cut, before));
    CHECK(cut.identity() == before.identity());
}

// Every vertex of every triangle has a place of its own.
TriangleMesh unwelded(const TriangleMesh& mesh) {
    TriangleMesh result;
    for (const std::uint32_t i : mesh.indices) {
        result.indices.push_back(static_cast<std::uint32_t>(result.positions.size()));
        result.positions.push_back(mesh.positions[i]);
    }
    return result;
}

// What views from around the mesh list, and how near it is then.
Vector<std::uint64_t> seen_from_around(const ClusteredMesh& mesh, DepthRange range) {
    Vector<std::uint64_t> numbers;
    depth::DepthCuller culler;
    for (int view = 0; view < 6; ++view) {
        const Camera camera{.position = {90.0 * std::cos(view), 20.0 - 7.0 * view, 90.0 * std::sin(view)},
                            .forward = {-std::cos(view), 0.0, -std::sin(view)}};
        std::vector<depth::DepthObject> objects;
        for (int i = 0; i < 3; ++i)
            objects.push_back({&mesh, glm::mat4(world_to_clip(camera) *
                                                glm::translate(glm::dmat4(1.0), glm::dvec3(0.0, 9.0 * i, 0.0)))});
        const auto found = culler.find_visible(objects, {.width = 200, .height = 120, .depth = range});
        for (const depth::VisibleCluster& c : *found) numbers.insert(numbers.end(), {c.object, c.cluster, c.triangles});
        for (std::uint32_t p = 0; p < 200 * 120; p += 7)
            numbers.push_back(std::bit_cast<std::uint32_t>(culler.nearness(p % 200, p / 200)));
    }
    return numbers;
}

TEST_CASE("a mesh that is lent is read in place: the same answers, with a fraction of the memory") {
    oracle::NearMisses random(10);
    for (const bool welded : {true, false})
        for (const std::uint32_t most : {3u, 16u, 64u}) {
            TriangleMesh mesh = hills(40, 50.0f, 5.0f, random);
            if (!welded) mesh = unwelded(mesh);
            ClusteredMesh cut = ClusteredMesh::cut(mesh.positions, mesh.indices, {.max_triangles = most}).value();
            const ClusteredMesh own = cut;
            Vector<std::uint32_t> permuted(mesh.indices.size());
            cut.permute(mesh.indices, permuted);
            REQUIRE(cut.lend(mesh.positions, permuted));
            CHECK(cut.triangle_order().empty());
            CHECK(cut.triangle_count() == mesh.triangle_count());
            CHECK(cut.identity() == own.identity());
            CHECK(seen_from_around(cut, DepthRange::reversed_zero_to_one) ==
                  seen_from_around(own, DepthRange::reversed_zero_to_one));
            Vector<std::uint32_t> in_order(permuted.size());
            cut.permute(permuted, in_order);
            CHECK(in_order == permuted);
            // Bytes are those of the mesh in order.
            const ClusteredMesh read = ClusteredMesh::deserialise(cut.serialise()).value();
            CHECK(seen_from_around(read, DepthRange::minus_one_to_one) ==
                  seen_from_around(own, DepthRange::minus_one_to_one));
            read.permute(permuted, in_order);
            CHECK(in_order == permuted);
            // The same of the mesh as it was cut: the order stays.
            ClusteredMesh as_cut = own;
            REQUIRE(as_cut.lend(mesh.positions, mesh.indices, depth::IndexOrder::original));
            CHECK(std::ranges::equal(as_cut.triangle_order(), own.triangle_order()));
            CHECK(as_cut.memory() < own.memory() - 12 * 41 * 41);
            CHECK(seen_from_around(as_cut, DepthRange::zero_to_one) == seen_from_around(own, DepthRange::zero_to_one));
            CHECK(as_cut.serialise() == own.serialise());
            const ClusteredMesh copied = as_cut;
            CHECK(copied.serialise() == own.serialise());
            // Then permuted, which may be lent after that.
            REQUIRE(as_cut.lend(mesh.positions, permuted));
            CHECK(as_cut.triangle_order().empty());
            CHECK(as_cut.memory() == cut.memory());
            CHECK(as_cut.lend(mesh.positions, mesh.indices, depth::IndexOrder::original).error().code ==
                  ErrorCode::invalid_argument);
            const double given = double(mesh.positions.size() * 12 + mesh.indices.size() * 4);
            if (most == 64) CHECK(double(cut.memory()) < (welded ? 0.16 : 0.08) * given);
        }
}

TEST_CASE("what is moved from is a mesh without clusters, and a copy is as the mesh") {
    oracle::NearMisses random(14);
    const TriangleMesh mesh = hills(30, 50.0f, 5.0f, random);
    ClusteredMesh cut = ClusteredMesh::cut(mesh.positions, mesh.indices).value();
    const ClusteredMesh copied = cut;
    ClusteredMesh moved = std::move(cut);
    CHECK(cut.clusters().empty());  // NOLINT: what is left
    CHECK(cut.triangle_count() == 0);
    CHECK(cut.triangle_order().empty());
    CHECK(cut.identity() == 0);
    CHECK(same(moved, copied));
    cut = copied;
    CHECK(same(cut, moved));
    moved = ClusteredMesh();
    CHECK(same(moved, ClusteredMesh()));
}

TEST_CASE("only the mesh that was cut can be lent") {
    oracle::NearMisses random(11);
    TriangleMesh mesh = hills(10, 50.0f, 5.0f, random);
    ClusteredMesh cut = ClusteredMesh::cut(mesh.positions, mesh.indices).value();
    const ClusteredMesh before = cut;
    Vector<std::uint32_t> permuted(mesh.indices.size());
    cut.permute(mesh.indices, permuted);
    CHECK(cut.lend(mesh.positions, std::span(permuted).first(3)).error().code == ErrorCode::invalid_argument);
    CHECK(cut.lend(mesh.positions, mesh.indices).error().code == ErrorCode::invalid_argument);
    CHECK(cut.lend(mesh.positions, permuted, depth::IndexOrder::original).error().code == ErrorCode::invalid_argument);
    CHECK(cut.lend(std::span(mesh.positions).first(3), permuted).error().code == ErrorCode::out_of_range);
    mesh.positions[permuted[100]].y += 1.0f;
    CHECK(cut.lend(mesh.positions, permuted).error().code == ErrorCode::invalid_argument);
    CHECK(same(cut, before));
}

TEST_CASE("triangles that share an edge by three, or in one direction, or have equal corners lose nothing") {
    const std::vector<glm::vec3> corners = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 0, 0.5f}};
    oracle::NearMisses random(12);
    depth::DepthCuller culler;
    std::uint64_t listed = 0, total = 0;
    for (std::uint64_t seed = 0; seed < 150; ++seed) {
        Scene scene;
        for (int m = 0; m < 3; ++m) {
            TriangleMesh mesh;
            mesh.positions.assign(corners.begin(), corners.end());
            for (int i = 0; i < 3 * 12; ++i) mesh.indices.push_back(static_cast<std::uint32_t>(random.index(5)));
            scene.meshes.emplace_back(std::move(mesh));
            const glm::dvec3 at(random.number(-1, 1), random.number(-1, 1), -4.0 - 2.0 * m);
            scene.objects.push_back(
                {&scene.meshes.back(), placed(at, glm::dvec3(1.5 + m), {0, 1, 0}, random.number(-1, 1)), m == 1});
        }
        const Checked c = check(scene, Camera{.aspect = 1.5}, 90, 60, seed, culler);
        CHECK(c.lost == 0);
        CHECK(c.too_near == 0);
        listed += c.listed, total += c.total;
    }
    CHECK(listed < total);
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
    // All of the header's counts, the clusters' counts and the order.
    CHECK(refused > 3 * (20 + cut.clusters().size() + 4 * cut.triangle_order().size()));
}

// Bytes of a mesh whose clusters have one triangle each, and where their lists begin.
struct StoredBytes {
    static constexpr std::size_t kHeader = 56, kCorners = 8, kBits = 16, kLargest = 20;  // counts are words

    Vector<std::byte> bytes;
    std::size_t boxes, order, corners;

    explicit StoredBytes(const ClusteredMesh& mesh) : bytes(mesh.serialise()) {
        const std::size_t clusters = mesh.clusters().size();
        boxes = kHeader + (clusters + 3) / 4 * 4;
        order = boxes + 32 * clusters;
        corners = order + 4 * mesh.triangle_count();
    }
    template <class T>
    void set(std::size_t at, T value) {
        std::memcpy(&bytes[at], &value, sizeof value);
    }
    [[nodiscard]] std::uint32_t word(std::size_t at) const {
        std::uint32_t value;
        std::memcpy(&value, &bytes[at], sizeof value);
        return value;
    }
    void insert(std::size_t at, std::size_t count) {
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), count, std::byte(0));
    }
    [[nodiscard]] bool is_refused() const {
        const auto read = ClusteredMesh::deserialise(bytes);
        return !read && read.error().code == ErrorCode::parse;
    }
};

// How many half edges vertices reach from the middle at most, in more digits than double has.
long double reach_of(const ClusterBox& box, const std::vector<glm::vec3>& vertices) {
    using Vec = std::array<long double, 3>;
    const auto cross = [](const Vec& a, const Vec& b) {
        return Vec{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    };
    const auto dot = [](const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
    std::array<Vec, 3> edges;
    for (std::size_t k = 0; k < 3; ++k) edges[k] = {box.half_edges[k].x, box.half_edges[k].y, box.half_edges[k].z};
    long double most = 0.0L;
    for (const glm::vec3& p : vertices)
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec normal = cross(edges[(k + 1) % 3], edges[(k + 2) % 3]);
            Vec from_center;
            for (std::size_t i = 0; i < 3; ++i) {
                const auto axis = static_cast<glm::length_t>(i);
                from_center[i] = static_cast<long double>(p[axis]) - static_cast<long double>(box.center[axis]);
            }
            const long double share = std::abs(dot(from_center, normal) / dot(edges[k], normal));
            most = share <= most ? most : share;
        }
    return most;
}

TEST_CASE("bytes are refused if and only if a box does not contain its triangles, or the mesh's box all of them") {
    oracle::NearMisses random(19);
    int taken = 0, refused = 0;
    for (int round = 0; round < 60; ++round) {
        TriangleMesh mesh = hills(4, 50.0f, 5.0f, random);
        const auto away = static_cast<float>(std::pow(10.0, random.number(-3, 5)));
        for (glm::vec3& p : mesh.positions) p += glm::vec3(away, 0.0f, -0.3f * away);
        const ClusteredMesh cut =
            ClusteredMesh::cut(mesh.positions, mesh.indices, {.max_triangles = round % 3 == 0 ? 1u : 7u}).value();
        const std::size_t clusters = cut.clusters().size();
        std::vector<std::vector<glm::vec3>> vertices(clusters + 1);
        for (std::size_t c = 0; c < clusters; ++c)
            for (std::uint32_t t = 0; t < 3 * cut.triangles_of(c); ++t) {
                const std::uint32_t triangle = cut.triangle_order()[cut.clusters()[c].first_triangle + t / 3];
                vertices[c].push_back(mesh.positions[mesh.indices[3 * std::size_t{triangle} + t % 3]]);
                vertices[clusters].push_back(vertices[c].back());
            }
        const StoredBytes whole(cut);
        REQUIRE_FALSE(whole.is_refused());
        for (int change = 0; change < 100; ++change) {
            // A bit of a box's centers, edges and exponent, or of the mesh's box.
            StoredBytes forged = whole;
            const bool of_all = random.index(6) == 0;
            const std::size_t c = of_all ? clusters : random.index(static_cast<unsigned>(clusters));
            const std::size_t begin = of_all ? StoredBytes::kHeader - 24 : whole.boxes + 32 * c;
            const std::size_t word = begin + 4 * random.index(of_all ? 6 : 8);
            forged.set(word, forged.word(word) ^ std::uint32_t{1} << random.index(24));
            ClusterBox box;
            if (of_all) {
                glm::vec3 numbers[2];
                std::memcpy(numbers, &forged.bytes[begin], sizeof numbers);
                box.center = numbers[0];
                for (glm::length_t k = 0; k < 3; ++k) box.half_edges[std::size_t(k)][k] = numbers[1][k];
            } else {
                ClusteredMesh::PackedBox packed;
                std::memcpy(&packed, &forged.bytes[begin], sizeof packed);
                box = packed.unpacked();
            }
            const long double reach = reach_of(box, vertices[c]);
            CAPTURE(static_cast<double>(reach));
            if (forged.is_refused()) {
                ++refused;
                CHECK_FALSE(reach < 1.0L - 0x1p-40L);
            } else {
                ++taken;
                CHECK(reach <= 1.0L + 0x1p-55L);
            }
        }
    }
    CHECK(taken > 1000);
    CHECK(refused > 1000);
}

TEST_CASE("bytes that are one off in a count, an index or a sign are refused, though all lists have that length") {
    oracle::NearMisses random(13);
    const TriangleMesh mesh = hills(4, 50.0f, 5.0f, random);
    const ClusteredMesh cut = ClusteredMesh::cut(mesh.positions, mesh.indices, {.max_triangles = 1}).value();
    const StoredBytes whole(cut);
    CHECK_FALSE(whole.is_refused());
    SUBCASE("no cluster") {
        StoredBytes none = whole;
        none.bytes.assign(StoredBytes::kHeader, std::byte(0));
        none.set(StoredBytes::kBits, 1u);
        CHECK(none.is_refused());
    }
    SUBCASE("corners of no bits, of more than a byte, or of fewer than a cluster takes off") {
        for (const std::uint32_t bits : {0u, 9u, 0x80000000u}) {
            StoredBytes other = whole;
            other.set(StoredBytes::kBits, bits);
            CHECK(other.is_refused());
        }
        StoredBytes other = whole;
        REQUIRE(whole.word(StoredBytes::kBits) == 2);
        other.set(StoredBytes::kHeader, std::byte(0x80));
        CHECK(other.is_refused());
    }
    SUBCASE("a word more of corners than clusters have") {
        StoredBytes more = whole;
        more.set(StoredBytes::kCorners, whole.word(StoredBytes::kCorners) + 1);
        more.insert(whole.corners + std::size_t{4} * whole.word(StoredBytes::kCorners), 4);
        CHECK(more.is_refused());
    }
    SUBCASE("an order that names the triangle after the last") {
        StoredBytes other = whole;
        other.set(whole.order, static_cast<std::uint32_t>(cut.triangle_count()));
        CHECK(other.is_refused());
    }
    SUBCASE("a negative largest coordinate") {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            StoredBytes other = whole;
            other.set(StoredBytes::kLargest + 4 * axis, -1.0f);
            CHECK(other.is_refused());
        }
    }
}

}  // namespace
}  // namespace crofton::testing
