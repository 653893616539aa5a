// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <box_mesh.hpp>
#include <cmath>
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "shape/mesh/meshes.hpp"

using namespace crofton;
using namespace crofton::collide;
using namespace crofton::testing;

namespace {

Manifold manifold_of(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& pose) {
    Vector<mesh::MeshContact> contacts;
    mesh::contacts(a, b, pose, contacts);
    return contact_manifold(a, b, pose, contacts);
}

// By latitude and longitude.
TriangleMesh sphere(double radius) {
    constexpr std::uint32_t kRings = 40, kAround = 60;
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i <= kRings; ++i)
        for (std::uint32_t j = 0; j < kAround; ++j) {
            const double v = std::numbers::pi * i / kRings, u = 2.0 * std::numbers::pi * j / kAround;
            const double across = i == 0 || i == kRings ? 0.0 : std::sin(v);
            mesh.positions.push_back(
                glm::vec3(radius * glm::dvec3(across * std::cos(u), across * std::sin(u), std::cos(v))));
        }
    for (std::uint32_t i = 0; i < kRings; ++i)
        for (std::uint32_t j = 0; j < kAround; ++j) {
            const std::uint32_t a = i * kAround + j, b = i * kAround + (j + 1) % kAround, c = b + kAround,
                                d = a + kAround;
            if (i > 0) mesh.indices.insert(mesh.indices.end(), {a, d, b});
            if (i + 1 < kRings) mesh.indices.insert(mesh.indices.end(), {b, d, c});
        }
    return mesh;
}

}  // namespace

TEST_SUITE("collide/mesh_manifold") {
    TEST_CASE("a cube on a floor: four points near its corners, as deep as it has sunk, in the floor's frame") {
        TriangleMesh sheet;
        sheet.positions = {{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}};
        sheet.indices = {0, 1, 2, 0, 2, 3};
        TriangleMesh slab = cube_mesh(9.0f);
        for (glm::vec3& p : slab.positions) p.z -= 9.0f;
        const auto crate = tree_of(cube_mesh(1.0f));
        for (const TriangleMesh& mesh : {sheet, slab}) {
            const auto floor = tree_of(mesh);
            const RigidTransform pose{glm::dmat3(1.0), {2.3, 1.1, 0.9}};
            const Manifold m = manifold_of(floor, crate, pose);
            REQUIRE(m.count == 4);
            CHECK(m.normal.z == doctest::Approx(1.0));
            CHECK(m.depth == doctest::Approx(0.1));
            double signs[2] = {0.0, 0.0};
            for (int i = 0; i < 4; ++i) {
                CHECK(m.points[i].depth == doctest::Approx(0.1).epsilon(1e-5));
                CHECK(m.points[i].position.z == doctest::Approx(-0.05).epsilon(1e-5));
                for (int k = 0; k < 2; ++k) {
                    const double from = m.points[i].position[k] - pose.translation[k];
                    CHECK(std::abs(from) > 0.9);
                    CHECK(std::abs(from) <= 1.0);
                    signs[k] += from > 0.0 ? 1.0 : -1.0;
                }
            }
            CHECK(signs[0] == 0.0);
            CHECK(signs[1] == 0.0);
            // The other way round the normal points down, in the crate's frame.
            const Manifold back = manifold_of(crate, floor, inverse(pose));
            REQUIRE(back.count == 4);
            CHECK(back.normal.z == doctest::Approx(-1.0));
            CHECK(back.depth == doctest::Approx(0.1).epsilon(1e-5));
            CHECK(back.points[0].position.z == doctest::Approx(-0.95).epsilon(1e-5));
        }
    }

    TEST_CASE("two spheres: the deepest point is in the middle, along the line of centres") {
        const auto a = tree_of(sphere(1.0)), b = tree_of(sphere(0.6));
        std::mt19937_64 random(51);
        for (int trial = 0; trial < 40; ++trial) {
            const glm::dvec3 way = glm::normalize(random_vector(random));
            const double depth = 0.02 + 0.005 * trial;
            const RigidTransform pose{glm::mat3_cast(random_rotation(random)), (1.6 - depth) * way};
            const Manifold m = manifold_of(a, b, pose);
            REQUIRE(m.count >= 3);
            REQUIRE(m.count <= 4);
            CHECK(glm::dot(m.normal, way) > 0.99);
            CHECK(m.depth == doctest::Approx(depth).epsilon(0.2));  // facets of 3°
            for (int i = 0; i < m.count; ++i) {
                CHECK(m.points[i].depth >= 0.0);
                CHECK(m.points[i].depth <= m.depth);
                CHECK(glm::length(m.points[i].position) <= 1.01);
                CHECK(glm::distance(m.points[i].position, pose.translation) <= 0.61);
            }
        }
    }

    TEST_CASE("points lie midway between the surfaces, a depth apart along the normal, whatever the pose") {
        const TriangleMesh ring = wavy_torus(1.0, 0.3, 0.2);
        const auto tree = tree_of(ring), crate = tree_of(cube_mesh(0.5f));
        std::mt19937_64 random(52);
        int touching = 0, deep = 0;
        for (int trial = 0; trial < 300; ++trial) {
            const RigidTransform pose = random_pose(random, 1.3);
            const Manifold m = manifold_of(tree, crate, pose);
            REQUIRE((m.count > 0) == mesh::intersects(tree, crate, pose));
            if (m.count == 0) continue;
            ++touching;
            CHECK(m.count <= 4);
            CHECK(glm::length(m.normal) == doctest::Approx(1.0));
            double deepest = 0.0;
            for (int i = 0; i < m.count; ++i) {
                const ContactPoint& p = m.points[i];
                deepest = std::max(deepest, p.depth);
                if (p.depth < 1e-5) continue;
                ++deep;
                // Its surfaces are half a depth away along the normal.
                const glm::dvec3 above = p.position + (0.5 * p.depth - 1e-5) * m.normal;
                CHECK(mesh::contains(tree, above));
                const glm::dvec3 beyond = p.position + (0.5 * p.depth + 1e-5) * m.normal;
                CHECK_FALSE(mesh::contains(tree, beyond));
                const glm::dvec3 within = p.position - (0.5 * p.depth - 1e-5) * m.normal;
                CHECK(mesh::contains(crate, transform(inverse(pose), within)));
                const glm::dvec3 below = p.position - (0.5 * p.depth + 1e-5) * m.normal;
                CHECK_FALSE(mesh::contains(crate, transform(inverse(pose), below)));
            }
            CHECK(m.depth == deepest);
        }
        CHECK(touching > 60);
        CHECK(deep > touching);
    }

    TEST_CASE("no contacts, no points") {
        const auto a = tree_of(cube_mesh(1.0f));
        CHECK(manifold_of(a, a, {glm::dmat3(1.0), {3.0, 0.0, 0.0}}).count == 0);
    }
}
