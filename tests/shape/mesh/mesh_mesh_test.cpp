// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <box_mesh.hpp>
#include <cmath>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include <crofton/geometry/closest_points.hpp>
#include "../../ranges.hpp"
#include "shape/mesh/meshes.hpp"

using namespace crofton;
using namespace crofton::mesh;
using namespace crofton::testing;

namespace {

Vector<TrianglePair> brute_force(const TriangleMesh& a, const TriangleMesh& b, const RigidTransform& pose) {
    Vector<TrianglePair> pairs;
    for (std::uint32_t i = 0; i < a.triangle_count(); ++i)
        for (std::uint32_t j = 0; j < b.triangle_count(); ++j)
            if (intersects(triangle(a, i, {}), triangle(b, j, pose))) pairs.push_back({i, j});
    return pairs;
}

// One triangle in the plane z = 0 and, as another mesh, `count` small ones that pierce it, with numbers `step` apart:
// those between lie elsewhere.
void pierced(std::size_t count, std::size_t step, TriangleMesh& large, TriangleMesh& small) {
    large.positions = {{-9.0f, -9.0f, 0.0f}, {30.0f, -9.0f, 0.0f}, {-9.0f, 30.0f, 0.0f}};
    large.indices = {0, 1, 2};
    for (std::size_t t = 0; t < count * step; ++t) {
        const std::size_t place = t * 7919 % (count * step);
        const float x = 0.1f * static_cast<float>(place % 64), y = 0.1f * static_cast<float>(place / 64 % 64);
        const float z = t % step == 0 ? 0.0f : 5.0f;
        for (const glm::vec3 corner :
             {glm::vec3(x, y, z - 1.0f), glm::vec3(x + 0.01f, y, z + 1.0f), glm::vec3(x, y + 0.01f, z + 1.0f)}) {
            small.indices.push_back(static_cast<std::uint32_t>(small.positions.size()));
            small.positions.push_back(corner);
        }
    }
}

}  // namespace

TEST_SUITE("mesh/mesh_mesh") {
    TEST_CASE("a tree of no triangles meets, holds and is near to nothing") {
        const MeshTree none;
        const auto some = MeshTree::build(wavy_torus(1.0, 0.4, 0.0));
        REQUIRE(some.has_value());
        const MeshTree* const pairs[][2] = {{&none, &*some}, {&*some, &none}, {&none, &none}};
        for (const auto& pair : pairs) {
            const MeshTree *const a = pair[0], *const b = pair[1];
            Vector<TrianglePair> met;
            Vector<MeshContact> touching;
            CHECK_FALSE(intersects(*a, *b, {}));
            intersecting_triangles(*a, *b, {}, met);
            contacts(*a, *b, {}, touching);
            CHECK(met.empty());
            CHECK(touching.empty());
            CHECK(std::isinf(distance(*a, *b, {}).distance));
            CHECK_FALSE(closer_than(*a, *b, {}, 10.0));
            CHECK(containment(*a, *b, {}) == Containment::none);
            CHECK(separating_motion(*a, *b, {}, {}).depth == 0.0);
        }
        CHECK_FALSE(contains(none, glm::dvec3(0.0)));
    }

    TEST_CASE("pairs come in order, few or many, near in number or far") {
        for (const std::size_t count : {1u, 20u, 30u, 300u, 2500u})
            for (const std::size_t step : {1u, 40u}) {
                TriangleMesh large, small;
                pierced(count, step, large, small);
                const auto one = mesh::MeshTree::build(large), many = mesh::MeshTree::build(small);
                REQUIRE(one.has_value());
                REQUIRE(many.has_value());
                Vector<TrianglePair> to_many, to_one;
                intersecting_triangles(*one, *many, RigidTransform{}, to_many);
                intersecting_triangles(*many, *one, RigidTransform{}, to_one);
                REQUIRE(to_many.size() == count);
                REQUIRE(to_one.size() == count);
                for (std::size_t i = 0; i < count; ++i) {
                    CHECK(to_many[i] == TrianglePair{0, static_cast<std::uint32_t>(i * step)});
                    CHECK(to_one[i] == TrianglePair{static_cast<std::uint32_t>(i * step), 0});
                }
            }
    }

    TEST_CASE("a triangle with NaN or a wild index is left out by name, and its neighbours are found all the same") {
        TriangleMesh a = wavy_torus(1.0, 0.4, 0.1), b = a;
        const RigidTransform pose{glm::dmat3(1.0), {0.7, 0.1, 0.05}};
        auto expected = brute_force(a, b, pose);
        a.positions.push_back(glm::vec3(std::nanf(""), 0.0f, 0.0f));
        const auto bad_vertex = std::uint32_t(a.positions.size() - 1);
        for (const std::uint32_t index : {0u, 1u, bad_vertex, 0u, 1u, 9999u}) a.indices.push_back(index);
        const auto tree_a = tree_of(a), tree_b = tree_of(b);
        CHECK(test::ranges::equal(tree_a.rejected(), Vector<std::uint32_t>{576, 577}));
        CHECK(tree_a.triangle_count() == 576);
        Vector<TrianglePair> pairs;
        intersecting_triangles(tree_a, tree_b, pose, pairs);
        CHECK_FALSE(expected.empty());
        CHECK(pairs == expected);
    }

    TEST_CASE("poses that are no rigid motions are refused by name") {
        RigidTransform pose;
        CHECK(validate(pose).has_value());
        pose.rotation[0][0] = 2.0;
        CHECK(error_of(validate(pose, 3)).item == 3);
        pose = {};
        pose.translation.z = std::numeric_limits<double>::quiet_NaN();
        CHECK(error_of(validate(pose)).code == ErrorCode::non_finite);
        pose = {};
        pose.translation.z = 1e19;
        CHECK(error_of(validate(pose)).code == ErrorCode::out_of_range);
    }

    TEST_CASE("the same pairs of triangles as brute force, for generic, coincident and face-to-face poses") {
        std::mt19937_64 random(9);
        const TriangleMesh meshes[] = {wavy_torus(1.0, 0.4, 0.2), wavy_torus(0.6, 0.5, 0.0, 12, 9), cube_mesh(0.7f)};
        for (int trial = 0; trial < 60; ++trial) {
            const TriangleMesh &a = meshes[trial % 3], &b = meshes[trial / 3 % 3];
            RigidTransform pose = random_pose(random, 1.2);
            if (trial % 5 == 0) pose = {glm::dmat3(1.0), {}};
            if (trial % 5 == 1) pose = {glm::dmat3(1.0), {1.4, 0.0, 0.25}};
            if (trial % 5 == 2) pose.translation *= 0.2;
            const auto tree_a = tree_of(a), tree_b = tree_of(b);
            const auto expected = brute_force(a, b, pose);
            Vector<TrianglePair> pairs;
            MeshStatistics statistics;
            intersecting_triangles(tree_a, tree_b, pose, pairs, &statistics);
            CHECK(pairs == expected);
            CHECK(statistics.triangle_tests >= pairs.size());
            CHECK(statistics.triangle_tests <= tree_a.triangle_count() * tree_b.triangle_count());
            CHECK(statistics.exact_tests <= statistics.triangle_tests);
            CHECK(statistics.box_tests > 0);
            CHECK(intersects(tree_a, tree_b, pose) == !expected.empty());
            CHECK(intersects(tree_b, tree_a, inverse(pose)) == !expected.empty());
            Vector<MeshContact> found;
            contacts(tree_a, tree_b, pose, found);
            CHECK(found.size() == expected.size());
        }
    }

    TEST_CASE("whether meshes meet is known at the first pair that does") {
        const TriangleMesh torus = wavy_torus(1.0, 0.4, 0.2, 60, 40);
        const auto tree = tree_of(torus);
        const RigidTransform pose{glm::dmat3(1.0), {0.0, 0.0, 0.0}};  // every triangle meets its own copy
        MeshStatistics all, first;
        Vector<TrianglePair> pairs;
        intersecting_triangles(tree, tree, pose, pairs, &all);
        REQUIRE(pairs.size() >= torus.triangle_count());
        CHECK(intersects(tree, tree, pose, &first));
        CHECK(first.triangle_tests < all.triangle_tests / 10);
        CHECK(first.box_tests < all.box_tests / 10);
    }

    TEST_CASE("meshes of every size from 1e-15 to 1e12 give the same pairs as brute force") {
        std::mt19937_64 random(10);
        for (const double size : {1e-15, 1e-9, 1e-3, 1e5, 2e11}) {
            TriangleMesh a = wavy_torus(1.0, 0.4, 0.2, 12, 8);
            for (glm::vec3& p : a.positions) p *= float(size);
            const auto tree = tree_of(a);
            for (int trial = 0; trial < 4; ++trial) {
                const RigidTransform pose = random_pose(random, size);
                Vector<TrianglePair> pairs;
                intersecting_triangles(tree, tree, pose, pairs);
                CHECK(pairs == brute_force(a, a, pose));
            }
        }
    }

    TEST_CASE("contacts come in order with the segments and normals of their triangles, to the bit") {
        std::mt19937_64 random(15);
        const TriangleMesh mesh = wavy_torus(1.0, 0.4, 0.2, 200, 90);
        const auto tree = tree_of(mesh);
        std::size_t most = 0;
        for (int trial = 0; trial < 12; ++trial) {
            RigidTransform pose = random_pose(random, 0.3);
            if (trial == 0) pose.rotation = glm::dmat3(1.0), pose.translation = {0.0, 0.0, 0.05};
            Vector<TrianglePair> pairs;
            Vector<MeshContact> found;
            intersecting_triangles(tree, tree, pose, pairs);
            contacts(tree, tree, pose, found);
            REQUIRE(found.size() == pairs.size());
            most = std::max(most, found.size());
            for (std::size_t i = 0; i < found.size(); ++i) {
                REQUIRE(found[i].triangles == pairs[i]);
                const Triangle a = triangle(mesh, pairs[i].first, {}), b = triangle(mesh, pairs[i].second, pose);
                SegmentOfContact segment = contact_segment(a, b);
                const glm::dvec3 along =
                    glm::cross(glm::cross(a[1] - a[0], a[2] - a[0]), glm::cross(b[1] - b[0], b[2] - b[0]));
                if (glm::dot(along, segment.end - segment.begin) < 0.0) std::swap(segment.begin, segment.end);
                REQUIRE(found[i].segment.begin == segment.begin);
                REQUIRE(found[i].segment.end == segment.end);
                const glm::dvec3 n = glm::cross(b[1] - b[0], b[2] - b[0]);
                REQUIRE(found[i].normal == n / glm::length(n));
            }
        }
        CHECK(most > 2048);  // more than are sorted by their places
    }

    TEST_CASE(
        "under a pose that mirrors, contacts are those of the mirrored mesh, whose triangles look out as before") {
        std::mt19937_64 random(12);
        const TriangleMesh a = wavy_torus(1.0, 0.3, 0.2), b = wavy_torus(0.8, 0.4, 0.1);
        TriangleMesh image = b;
        for (glm::vec3& p : image.positions) p.z = -p.z;
        for (std::size_t i = 0; i < image.indices.size(); i += 3) std::swap(image.indices[i + 1], image.indices[i + 2]);
        const MeshTree of_a = tree_of(a), of_b = tree_of(b), of_image = tree_of(image);
        for (int i = 0; i < 20; ++i) {
            const RigidTransform pose = random_pose(random, 1.0);
            RigidTransform mirrors = pose;
            mirrors.rotation[2] = -mirrors.rotation[2];
            Vector<MeshContact> found, expected;
            contacts(of_a, of_b, mirrors, found);
            contacts(of_a, of_image, pose, expected);
            REQUIRE(found.size() == expected.size());
            for (std::size_t k = 0; k < found.size(); ++k) {
                REQUIRE(found[k].triangles == expected[k].triangles);
                CHECK(glm::dot(found[k].normal, expected[k].normal) > 1.0 - 1e-9);
                CHECK(glm::distance(found[k].segment.begin, expected[k].segment.begin) < 1e-9);
                CHECK(glm::distance(found[k].segment.end, expected[k].segment.end) < 1e-9);
            }
        }
    }
}
