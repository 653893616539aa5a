// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/mesh/mesh_query.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include <crofton/geometry/closest_points.hpp>
#include "mesh/meshes.hpp"

using namespace crofton;
using namespace crofton::mesh;
using namespace crofton::testing;

namespace {

mesh::MeshTree tree_of(const TriangleMesh& mesh) {
    auto tree = mesh::MeshTree::build(mesh);
    REQUIRE(tree.has_value());
    return std::move(*tree);
}

Triangle triangle(const TriangleMesh& mesh, std::size_t t, const RigidTransform& pose) {
    return {transform(pose, vertex(mesh, t, 0)), transform(pose, vertex(mesh, t, 1)),
            transform(pose, vertex(mesh, t, 2))};
}

Vector<TrianglePair> brute_force(const TriangleMesh& a, const TriangleMesh& b, const RigidTransform& pose) {
    Vector<TrianglePair> pairs;
    for (std::uint32_t i = 0; i < a.triangle_count(); ++i)
        for (std::uint32_t j = 0; j < b.triangle_count(); ++j)
            if (intersects(triangle(a, i, {}), triangle(b, j, pose))) pairs.push_back({i, j});
    return pairs;
}

TriangleMesh cube(double half) {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.positions.push_back(glm::vec3(half * (i & 1 ? 1 : -1), half * (i & 2 ? 1 : -1), half * (i & 4 ? 1 : -1)));
    mesh.indices = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                    2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    return mesh;
}

}  // namespace

namespace {

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
        CHECK(std::ranges::equal(tree_a.rejected(), Vector<std::uint32_t>{576, 577}));
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
        CHECK(validate(pose, 3).error().item == 3);
        pose = {};
        pose.translation.z = std::numeric_limits<double>::quiet_NaN();
        CHECK(validate(pose).error().code == ErrorCode::non_finite);
        pose = {};
        pose.translation.z = 1e19;
        CHECK(validate(pose).error().code == ErrorCode::out_of_range);
    }

    TEST_CASE("the same pairs of triangles as brute force, for generic, coincident and face-to-face poses") {
        std::mt19937_64 random(9);
        const TriangleMesh meshes[] = {wavy_torus(1.0, 0.4, 0.2), wavy_torus(0.6, 0.5, 0.0, 12, 9), cube(0.7)};
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
            CHECK(intersects(tree_a, tree_b, pose) == !expected.empty());
            CHECK(intersects(tree_b, tree_a, inverse(pose)) == !expected.empty());
            Vector<MeshContact> found;
            contacts(tree_a, tree_b, pose, found);
            CHECK(found.size() == expected.size());
        }
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

    TEST_CASE("one closed mesh inside the other is reported as such, and no other case is") {
        const auto outer = tree_of(cube(1.0)), inner = tree_of(cube(0.25)), ring = tree_of(wavy_torus(1.0, 0.3, 0.0));
        CHECK(containment(outer, inner, {glm::dmat3(1.0), {0.3, 0.0, 0.0}}) == Containment::b_inside_a);
        CHECK(containment(inner, outer, {glm::dmat3(1.0), {0.3, 0.0, 0.0}}) == Containment::a_inside_b);
        CHECK(containment(outer, inner, {glm::dmat3(1.0), {0.75, 0.0, 0.0}}) ==
              Containment::none);  // touches from inside
        CHECK(containment(outer, inner, {glm::dmat3(1.0), {3.0, 0.0, 0.0}}) == Containment::none);
        CHECK(containment(ring, inner, {}) == Containment::none);  // in the hole
        const auto pea = tree_of(cube(0.05));
        CHECK(containment(ring, pea, {glm::dmat3(1.0), {0.0, 1.0, 0.0}}) == Containment::b_inside_a);
        CHECK(contains(outer, {0.0, 0.0, 0.0}));  // straight below an edge's crossing and on diagonals
        CHECK(contains(outer, {1.0, 0.5, 0.5}));
        CHECK_FALSE(contains(outer, {1.0 + 1e-15, 0.5, 0.5}));
        CHECK_FALSE(contains(outer, {-1.0, -1.0, -2.0}));
    }

    TEST_CASE("of a mesh in several pieces each is asked, vertices that only coincide hold a piece together") {
        const auto pieces = [](std::initializer_list<glm::vec3> places, float half) {
            TriangleMesh mesh;
            for (const glm::vec3& place : places) {
                TriangleMesh one = cube(double(half));
                for (const std::uint32_t index : one.indices) {  // every triangle with corners of its own
                    mesh.indices.push_back(std::uint32_t(mesh.positions.size()));
                    mesh.positions.push_back(one.positions[index] + place);
                }
            }
            return tree_of(mesh);
        };
        const auto outer = tree_of(cube(1.0));
        const auto both = pieces({{-0.5f, 0.0f, 0.0f}, {0.5f, 0.0f, 0.0f}}, 0.1f);
        CHECK(both.pieces().size() == 2);
        CHECK(containment(outer, both, {}) == Containment::b_inside_a);
        CHECK(containment(both, outer, {}) == Containment::a_inside_b);
        for (const float first : {0.5f, 3.0f}) {  // whichever piece comes first
            const auto half = pieces({{first, 0.0f, 0.0f}, {3.5f - first, 0.0f, 0.0f}}, 0.1f);
            CHECK(containment(outer, half, {}) == Containment::partly);
            CHECK(containment(half, outer, {}) == Containment::partly);
        }
        CHECK(containment(outer, pieces({{3.0f, 0.0f, 0.0f}, {5.0f, 0.0f, 0.0f}}, 0.1f), {}) == Containment::none);
        // A shell with a hollow: what is in the hollow is outside.
        TriangleMesh shell = cube(1.0);
        const TriangleMesh hollow = cube(0.5);
        for (const std::uint32_t index : hollow.indices) shell.indices.push_back(index + 8);
        for (const glm::vec3& p : hollow.positions) shell.positions.push_back(p);
        CHECK(containment(tree_of(shell), tree_of(cube(0.25)), {}) == Containment::none);
        CHECK(containment(tree_of(shell), tree_of(cube(0.1)), {glm::dmat3(1.0), {0.75, 0.0, 0.0}}) ==
              Containment::b_inside_a);
    }

    TEST_CASE("an open mesh contains nothing: cubes that hover over and under a terrain are apart from it") {
        TriangleMesh terrain;
        for (std::uint32_t i = 0; i < 20; ++i)
            for (std::uint32_t j = 0; j < 20; ++j) {
                terrain.positions.push_back(
                    glm::vec3(float(i), float(j), 0.3f * float(std::sin(double(i) + 2.0 * double(j)))));
                if (i == 19 || j == 19) continue;
                const std::uint32_t at = 20 * i + j;
                for (const std::uint32_t v : {at, at + 20, at + 21, at, at + 21, at + 1}) terrain.indices.push_back(v);
            }
        const auto ground = tree_of(terrain), crate = tree_of(cube(0.2));
        REQUIRE(ground.pieces().size() == 1);
        CHECK_FALSE(ground.pieces()[0].closed);
        CHECK(crate.pieces()[0].closed);
        std::mt19937_64 random(31);
        for (int trial = 0; trial < 100; ++trial) {
            const double height = trial % 2 ? -2.0 : 2.0;
            const RigidTransform pose{
                glm::dmat3(1.0), {9.0 + 8.0 * random_vector(random).x, 9.0 + 8.0 * random_vector(random).x, height}};
            CHECK(containment(ground, crate, pose) == Containment::none);
            CHECK_FALSE(contains(ground, pose.translation));
        }
        // A hole opens a cube; so does a rejected triangle. A closed piece beside an open one still contains.
        TriangleMesh holed = cube(1.0);
        holed.indices.resize(33);
        CHECK(containment(tree_of(holed), crate, {}) == Containment::none);
        TriangleMesh torn = cube(1.0);
        torn.indices[35] = 99;
        CHECK(containment(tree_of(torn), crate, {}) == Containment::none);
        TriangleMesh mixed = cube(1.0);
        mixed.positions.insert(mixed.positions.end(), {{-0.1f, -0.1f, 2.0f}, {0.9f, 0.0f, 2.0f}, {0.0f, 0.9f, 2.0f}});
        mixed.indices.insert(mixed.indices.end(), {8, 9, 10});
        REQUIRE(tree_of(mixed).pieces().size() == 2);
        CHECK(tree_of(mixed).pieces()[0].closed);
        CHECK_FALSE(tree_of(mixed).pieces()[1].closed);
        CHECK(containment(tree_of(mixed), crate, {}) == Containment::b_inside_a);
        CHECK_FALSE(contains(tree_of(mixed), {0.2, 0.2, 1.5}));  // between the lid and the loose triangle
    }

    TEST_CASE(
        "closed pieces: whatever the winding, with vertices of their own, and where four triangles share an edge") {
        TriangleMesh turned = cube(1.0);
        std::swap(turned.indices[0], turned.indices[1]);
        CHECK(tree_of(turned).pieces()[0].closed);
        // Two cubes that touch along an edge, their vertices there one.
        TriangleMesh pair = cube(1.0);
        const std::uint32_t map[8] = {7, 8, 9, 10, 11, 12, 13, 14};  // the second's vertex 0 is the first's 7
        for (int v = 1; v < 8; ++v)
            pair.positions.push_back(cube(1.0).positions[std::size_t(v)] + glm::vec3(2.0f, 2.0f, 0.0f));
        for (const std::uint32_t v : cube(1.0).indices) pair.indices.push_back(v == 0 ? 3 : map[v]);
        const auto tree = tree_of(pair);
        REQUIRE(tree.pieces().size() == 1);
        CHECK(tree.pieces()[0].closed);
        CHECK(contains(tree, {0.0, 0.0, 0.0}));
        CHECK(contains(tree, {2.0, 2.0, 0.0}));
        CHECK_FALSE(contains(tree, {2.0, 0.0, 0.0}));
    }

    TEST_CASE("the depth is the shortest way out, of the directions tried") {
        const auto a = tree_of(cube(1.0)), b = tree_of(cube(0.5));
        const MeshDepth side = penetration(a, b, {glm::dmat3(1.0), {1.3, 0.1, 0.0}}, {});
        CHECK(side.depth == doctest::Approx(0.2).epsilon(1e-4));
        CHECK(side.direction.x == doctest::Approx(1.0));
        CHECK(penetration(a, b, {glm::dmat3(1.0), {0.1, 0.0, 0.0}}, {}).depth == doctest::Approx(1.4).epsilon(1e-4));
        CHECK(penetration(a, b, {glm::dmat3(1.0), {1.6, 0.1, 0.0}}, {}).depth == 0.0);
    }

    TEST_CASE(
        "the distance is, to the bit, the least of all pairs of triangles, near and far, of like and unlike size") {
        std::mt19937_64 random(13);
        for (int trial = 0; trial < 40; ++trial) {
            const TriangleMesh a = wavy_torus(1.0, 0.3, 0.2, 10, 8);
            TriangleMesh b = wavy_torus(0.7, 0.4, 0.1, 9, 7);
            const double size = trial % 4 == 0 ? 100.0 : 1.0;
            for (glm::vec3& p : b.positions) p *= float(size);
            const RigidTransform pose = random_pose(random, trial % 4 == 1 ? 50.0 : 4.0 * size);
            const auto tree_a = tree_of(a), tree_b = tree_of(b);
            ClosestPoints best;
            for (std::size_t i = 0; i < a.triangle_count(); ++i)
                for (std::size_t j = 0; j < b.triangle_count(); ++j)
                    closest_of_triangles(triangle(a, i, {}), triangle(b, j, pose), best);
            if (intersects(tree_a, tree_b, pose)) continue;
            CHECK(distance(tree_a, tree_b, pose).distance == std::sqrt(best.squared));
        }
    }

    TEST_CASE("beside triangles larger than itself a mesh is not opened: few pairs of triangles are looked at") {
        TriangleMesh small = wavy_torus(1.0, 0.3, 0.2, 96, 64);
        for (glm::vec3& p : small.positions) p *= 0.001f;
        const TriangleMesh large = wavy_torus(1.0, 0.3, 0.2, 10, 8);
        const auto tree_small = tree_of(small), tree_large = tree_of(large);
        std::mt19937_64 random(15);
        MeshStatistics statistics;
        for (int trial = 0; trial < 20; ++trial) {
            RigidTransform pose = random_pose(random, 0.0);
            pose.translation = (trial % 2 == 0 ? 1.4 : 3.0) * glm::normalize(random_vector(random));
            const double there =
                distance(tree_large, tree_small, pose, std::numeric_limits<double>::infinity(), &statistics).distance;
            const double back =
                distance(tree_small, tree_large, inverse(pose), std::numeric_limits<double>::infinity(), &statistics)
                    .distance;
            CHECK(there == doctest::Approx(back).epsilon(1e-12));
            if (trial >= 4) continue;
            ClosestPoints best;
            for (std::size_t i = 0; i < large.triangle_count(); ++i)
                for (std::size_t j = 0; j < small.triangle_count(); ++j)
                    closest_of_triangles(triangle(large, i, {}), triangle(small, j, pose), best);
            CHECK(there == std::sqrt(best.squared));
        }
        CHECK(statistics.triangle_tests / 40 < 20'000);  // of 2 million pairs
    }

    TEST_CASE("flat, sharp and empty triangles among large ones keep the exact distance") {
        std::mt19937_64 random(16);
        for (int trial = 0; trial < 60; ++trial) {
            TriangleMesh large;
            for (int t = 0; t < 7; ++t) {
                const glm::vec3 p(random_vector(random)), along(random_vector(random));
                const float sharp[] = {0.0f, 1e-30f, 1e-9f, 1e-4f, 1.0f};
                const glm::vec3 off = sharp[(trial + t) % 5] * glm::vec3(random_vector(random));
                for (const glm::vec3 corner : {p, t % 3 == 0 ? p : p + along, p + 0.3f * along + off}) {
                    large.indices.push_back(static_cast<std::uint32_t>(large.positions.size()));
                    large.positions.push_back(corner);
                }
            }
            TriangleMesh small = wavy_torus(1.0, 0.3, 0.2, 10, 8);
            for (glm::vec3& p : small.positions) p *= 0.01f;
            RigidTransform pose = random_pose(random, 0.0);
            pose.translation = 1.5 * random_vector(random);
            const auto tree_large = tree_of(large), tree_small = tree_of(small);
            if (intersects(tree_large, tree_small, pose)) continue;
            ClosestPoints best;
            for (std::size_t i = 0; i < large.triangle_count(); ++i)
                for (std::size_t j = 0; j < small.triangle_count(); ++j)
                    closest_of_triangles(triangle(large, i, {}), triangle(small, j, pose), best);
            CHECK(distance(tree_large, tree_small, pose).distance == std::sqrt(best.squared));
        }
    }

    TEST_CASE("far meshes are told apart along the way between them: few triangles are measured") {
        const auto ring = tree_of(wavy_torus(1.0, 0.3, 0.2, 96, 64));
        TriangleMesh large = wavy_torus(1.0, 0.3, 0.2, 96, 64);
        for (glm::vec3& p : large.positions) p *= 100.0f;
        const auto other = tree_of(large);
        std::mt19937_64 random(14);
        MeshStatistics statistics;
        for (int trial = 0; trial < 20; ++trial) {
            RigidTransform pose = random_pose(random, 0.0);
            pose.translation = 400.0 * glm::normalize(random_vector(random));
            (void)distance(ring, other, pose, std::numeric_limits<double>::infinity(), &statistics);
        }
        CHECK(statistics.exact_tests / 20 < 200);  // pairs of triangles, of 151 million
    }

    TEST_CASE("distance and tolerance agree with known gaps and with each other") {
        const auto a = tree_of(cube(1.0)), ring = tree_of(wavy_torus(1.0, 0.3, 0.2));
        const MeshDistance apart = distance(a, a, {glm::dmat3(1.0), {5.0, 6.0, 0.5}});
        CHECK(apart.distance == doctest::Approx(5.0));  // gaps 3 and 4 along two axes
        CHECK(glm::distance(apart.on_a, apart.on_b) == doctest::Approx(5.0));
        CHECK(distance(a, a, {glm::dmat3(1.0), {2.0, 0.0, 0.0}}).distance == 0.0);
        CHECK(distance(a, a, {glm::dmat3(1.0), {5.0, 6.0, 0.5}}, 4.9).distance ==
              std::numeric_limits<double>::infinity());
        CHECK(closer_than(a, a, {glm::dmat3(1.0), {5.0, 6.0, 0.5}}, 5.0 + 1e-12));
        CHECK_FALSE(closer_than(a, a, {glm::dmat3(1.0), {5.0, 6.0, 0.5}}, 5.0 - 1e-12));
        CHECK(closer_than(a, a, {glm::dmat3(1.0), {2.0, 0.0, 0.0}}, 0.0));
        std::mt19937_64 random(12);
        for (int trial = 0; trial < 50; ++trial) {
            const RigidTransform pose = random_pose(random, 4.0);
            const MeshDistance d = distance(a, ring, pose);
            CHECK((d.distance == 0.0) == intersects(a, ring, pose));
            if (d.distance == 0.0) continue;
            CHECK(closer_than(a, ring, pose, d.distance * (1.0 + 1e-9)));
            CHECK_FALSE(closer_than(a, ring, pose, d.distance * (1.0 - 1e-9)));
            const MeshDistance back = distance(ring, a, inverse(pose));
            CHECK(back.distance == doctest::Approx(d.distance).epsilon(1e-12));
        }
    }

    TEST_CASE("poses that miss by an ulp are apart: the distance is positive exactly where meshes do not meet") {
        const auto a = tree_of(cube(1.0)), ring = tree_of(wavy_torus(1.0, 0.3, 0.2));
        const double beyond = std::nextafter(2.0, 3.0);
        CHECK(distance(a, a, {glm::dmat3(1.0), {2.0, 0.0, 0.0}}).distance == 0.0);
        CHECK(distance(a, a, {glm::dmat3(1.0), {beyond, 0.3, 0.0}}).distance > 0.0);
        std::mt19937_64 random(32);
        int apart = 0, meeting = 0;
        for (int trial = 0; trial < 60; ++trial) {
            RigidTransform pose{glm::mat3_cast(random_rotation(random)), {0.0, 0.0, 0.0}};
            const glm::dvec3 direction = glm::normalize(random_vector(random));
            double near = 0.0, far = 8.0;  // bisected to neighbouring doubles
            for (int step = 0; step < 80; ++step) {
                const double middle = 0.5 * (near + far);
                pose.translation = middle * direction;
                (intersects(a, ring, pose) ? near : far) = middle;
            }
            for (const double along : {near, far}) {
                pose.translation = along * direction;
                const bool meets = intersects(a, ring, pose);
                CHECK((distance(a, ring, pose).distance == 0.0) == meets);
                (meets ? meeting : apart) += 1;
            }
        }
        CHECK(apart >= 30);
        CHECK(meeting >= 30);
    }
}
