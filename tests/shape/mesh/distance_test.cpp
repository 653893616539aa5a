// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <box_mesh.hpp>
#include <cmath>
#include <crofton/geometry/closest_points.hpp>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include "shape/mesh/meshes.hpp"

using namespace crofton;
using namespace crofton::mesh;
using namespace crofton::testing;

TEST_SUITE("mesh/distance") {
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

    TEST_CASE("queries with triangles larger than the mesh test few pairs of triangles") {
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

    TEST_CASE("distances of far meshes measure few triangles") {
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
        const auto a = tree_of(cube_mesh(1.0f)), ring = tree_of(wavy_torus(1.0, 0.3, 0.2));
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
        const auto a = tree_of(cube_mesh(1.0f)), ring = tree_of(wavy_torus(1.0, 0.3, 0.2));
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

    TEST_CASE("edges that cross at a small angle, and slivers, are as far apart as they are") {
        // Two long edges over each other, 1e-9 apart where they cross: their ends are ten times as far.
        TriangleMesh low, high;
        low.positions = {{-1.0f, 0.0f, 0.0f}, {1.0f, 0.0f, 0.0f}, {0.0f, 0.0f, -1.0f}};
        high.positions = {{-1.0f, -1e-8f, 1e-9f}, {1.0f, 1e-8f, 1e-9f}, {0.0f, 0.0f, 1.0f}};
        low.indices = high.indices = {0, 1, 2};
        const auto a = tree_of(low), b = tree_of(high);
        const double gap = double(1e-9f);
        CHECK(distance(a, b, {}).distance == doctest::Approx(gap).epsilon(1e-6));
        CHECK(closer_than(a, b, {}, 5e-9));
        // A point over a sliver that is turned in space. Its foot is at a third of each corner, so that the height is
        // known.
        std::mt19937_64 random(51);
        std::uniform_real_distribution<double> uniform(0.5, 1.0);
        for (int trial = 0; trial < 2000; ++trial) {
            const glm::dmat3 turn = glm::mat3_cast(random_rotation(random));
            const double thin = std::ldexp(uniform(random), -trial % 40),
                         height = std::ldexp(uniform(random), -trial % 30);
            const Triangle sliver = {turn * glm::dvec3(-1.0, 0.0, 0.0), turn * glm::dvec3(uniform(random), 0.0, 0.0),
                                     turn * glm::dvec3(0.1, thin, 0.0)};
            const glm::dvec3 foot = (sliver[0] + sliver[1] + sliver[2]) / 3.0, above = foot + height * turn[2];
            ClosestPoints best;
            closest_of_triangles(sliver, {above, above, above}, best);
            CHECK(std::abs(std::sqrt(best.squared) - height) < 1e-14);
        }
    }

    TEST_CASE("a limit that no distance is below gives up at once: zero, a negative number, NaN") {
        const auto a = tree_of(cube_mesh(1.0f));
        for (const double limit : {0.0, -1.0, std::nan("")})
            CHECK(distance(a, a, {}, limit).distance == std::numeric_limits<double>::infinity());
        CHECK(distance(a, a, {}, 1e-200).distance == 0.0);
    }

    TEST_CASE("the nearest point of a mesh to a point is the least of all its triangles") {
        std::mt19937_64 random(17);
        for (int trial = 0; trial < 60; ++trial) {
            TriangleMesh mesh = wavy_torus(1.0, 0.3, 0.2, 5 + std::uint32_t(trial) % 8, 4 + std::uint32_t(trial) % 5);
            if (trial % 5 == 0) mesh = box_mesh({-0.7f, -0.7f, -1.9f}, {1.3f, 0.3f, 2.1f});
            if (trial % 3 == 0)
                for (glm::vec3& p : mesh.positions) p.y *= 1e-6f;  // slivers
            const MeshTree tree = tree_of(mesh);
            for (int i = 0; i < 200; ++i) {
                glm::dvec3 point = std::pow(10.0, double(i % 7) - 3.0) * random_vector(random);
                if (i % 4 == 0) point += vertex(mesh, random() % mesh.triangle_count(), 0);
                double least = std::numeric_limits<double>::infinity();
                for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
                    least = std::min(least, glm::distance(point, closest_on_triangle(point, triangle(mesh, t, {}))));
                const MeshDistance found = distance_to_point(tree, point);
                const double slack = 1e-12 * (glm::length(point) + 2.0);
                CHECK(std::abs(found.distance - least) <= slack);
                CHECK(found.on_b == point);
                CHECK(std::abs(glm::distance(found.on_a, point) - found.distance) <= slack);
                const Triangle nearest = triangle(mesh, found.triangles.first, {});
                CHECK(glm::distance(found.on_a, closest_on_triangle(found.on_a, nearest)) <= slack);
            }
        }
    }

    TEST_CASE("a point is at distance 0 of a mesh iff it lies on a triangle, exactly") {
        std::mt19937_64 random(18);
        const TriangleMesh mesh = wavy_torus(1.0, 0.3, 0.2, 12, 9);
        TriangleMesh point_mesh;
        point_mesh.positions = {glm::vec3(0.0f)};
        point_mesh.indices = {0, 0, 0};
        const MeshTree tree = tree_of(mesh), dot = tree_of(point_mesh);
        int on = 0, off = 0;
        for (int i = 0; i < 4000; ++i) {
            const Triangle t = triangle(mesh, random() % mesh.triangle_count(), {});
            // Corners, middles of edges and dyadic points of the face, and the next numbers beside them.
            glm::dvec3 point = i % 3 == 0   ? t[0]
                               : i % 3 == 1 ? 0.5 * t[0] + 0.5 * t[1]
                                            : 0.5 * t[0] + 0.25 * (t[1] + t[2]);
            if (i % 2 == 0) point[i % 3] = std::nextafter(point[i % 3], i % 4 == 0 ? 9.0 : -9.0);
            const double asked = distance_to_point(tree, point).distance;
            CHECK((asked == 0.0) == intersects(tree, dot, {glm::dmat3(1.0), point}));
            ++(asked == 0.0 ? on : off);
        }
        CHECK(on > 1000);
        CHECK(off > 500);
    }

    TEST_CASE("a point so far that float has no room for it has a nearest point, one that is not finite none") {
        const MeshTree tree = tree_of(cube_mesh());
        for (const double far : {1e14, 1e16, 1e20, 1e29})
            CHECK(distance_to_point(tree, {far, 0.2, 0.1}).distance == doctest::Approx(far));
        for (const double bad : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
            CHECK(distance_to_point(tree, {0.0, bad, 0.0}).distance == std::numeric_limits<double>::infinity());
    }
}
