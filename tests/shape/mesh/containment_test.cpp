// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <box_mesh.hpp>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <limits>
#include <utility>

#include "shape/mesh/meshes.hpp"

using namespace crofton;
using namespace crofton::mesh;
using namespace crofton::testing;

TEST_SUITE("mesh/containment") {
    TEST_CASE("one closed mesh inside the other is reported as such, and no other case is") {
        const auto outer = tree_of(cube_mesh(1.0f)), inner = tree_of(cube_mesh(0.25f)),
                   ring = tree_of(wavy_torus(1.0, 0.3, 0.0));
        CHECK(containment(outer, inner, {glm::dmat3(1.0), {0.3, 0.0, 0.0}}) == Containment::b_inside_a);
        CHECK(containment(inner, outer, {glm::dmat3(1.0), {0.3, 0.0, 0.0}}) == Containment::a_inside_b);
        CHECK(containment(outer, inner, {glm::dmat3(1.0), {0.75, 0.0, 0.0}}) ==
              Containment::none);  // touches from inside
        CHECK(containment(outer, inner, {glm::dmat3(1.0), {3.0, 0.0, 0.0}}) == Containment::none);
        CHECK(containment(ring, inner, {}) == Containment::none);  // in the hole
        const auto pea = tree_of(cube_mesh(0.05f));
        CHECK(containment(ring, pea, {glm::dmat3(1.0), {0.0, 1.0, 0.0}}) == Containment::b_inside_a);
        CHECK(contains(outer, {0.0, 0.0, 0.0}));  // straight below an edge's crossing and on diagonals
        CHECK(contains(outer, {1.0, 0.5, 0.5}));
        CHECK_FALSE(contains(outer, {1.0 + 1e-15, 0.5, 0.5}));
        CHECK_FALSE(contains(outer, {-1.0, -1.0, -2.0}));
    }

    TEST_CASE("a point that is not finite, or too far for products in double, lies in no mesh") {
        const auto cube = tree_of(cube_mesh(1.0f));
        const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
        for (const glm::dvec3& place : {glm::dvec3(0.0), glm::dvec3(0.5, 0.25, 1.0), glm::dvec3(1.0, 0.5, -0.5)}) {
            REQUIRE(contains(cube, place));
            for (const double bad : {nan, infinite, -infinite, 1e200, -1e200})
                for (int axes = 1; axes < 8; ++axes) {
                    glm::dvec3 p = place;
                    for (int i = 0; i < 3; ++i)
                        if ((axes >> i & 1) != 0) p[i] = bad;
                    CHECK_FALSE(contains(cube, p));
                }
        }
    }

    TEST_CASE("containment tests each piece of a mesh, and vertices of equal position connect a piece") {
        const auto pieces = [](std::initializer_list<glm::vec3> places, float half) {
            TriangleMesh mesh;
            for (const glm::vec3& place : places) {
                TriangleMesh one = cube_mesh(half);
                for (const std::uint32_t index : one.indices) {  // every triangle with corners of its own
                    mesh.indices.push_back(std::uint32_t(mesh.positions.size()));
                    mesh.positions.push_back(one.positions[index] + place);
                }
            }
            return tree_of(mesh);
        };
        const auto outer = tree_of(cube_mesh(1.0f));
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
        TriangleMesh shell = cube_mesh(1.0f);
        const TriangleMesh hollow = cube_mesh(0.5f);
        for (const std::uint32_t index : hollow.indices) shell.indices.push_back(index + 8);
        for (const glm::vec3& p : hollow.positions) shell.positions.push_back(p);
        CHECK(containment(tree_of(shell), tree_of(cube_mesh(0.25f)), {}) == Containment::none);
        CHECK(containment(tree_of(shell), tree_of(cube_mesh(0.1f)), {glm::dmat3(1.0), {0.75, 0.0, 0.0}}) ==
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
        const auto ground = tree_of(terrain), crate = tree_of(cube_mesh(0.2f));
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
        TriangleMesh holed = cube_mesh(1.0f);
        holed.indices.resize(33);
        CHECK(containment(tree_of(holed), crate, {}) == Containment::none);
        TriangleMesh torn = cube_mesh(1.0f);
        torn.indices[35] = 99;
        CHECK(containment(tree_of(torn), crate, {}) == Containment::none);
        TriangleMesh mixed = cube_mesh(1.0f);
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
        TriangleMesh turned = cube_mesh(1.0f);
        std::swap(turned.indices[0], turned.indices[1]);
        CHECK(tree_of(turned).pieces()[0].closed);
        // Two cubes that touch along an edge, their vertices there one.
        TriangleMesh pair = cube_mesh(1.0f);
        const std::uint32_t map[8] = {7, 8, 9, 10, 11, 12, 13, 14};  // the second's vertex 0 is the first's 7
        for (int v = 1; v < 8; ++v)
            pair.positions.push_back(cube_mesh(1.0f).positions[std::size_t(v)] + glm::vec3(2.0f, 2.0f, 0.0f));
        for (const std::uint32_t v : cube_mesh(1.0f).indices) pair.indices.push_back(v == 0 ? 3 : map[v]);
        const auto tree = tree_of(pair);
        REQUIRE(tree.pieces().size() == 1);
        CHECK(tree.pieces()[0].closed);
        CHECK(contains(tree, {0.0, 0.0, 0.0}));
        CHECK(contains(tree, {2.0, 2.0, 0.0}));
        CHECK_FALSE(contains(tree, {2.0, 0.0, 0.0}));
    }

    TEST_CASE("a closed mesh that has shrunk to a point contains that point alone") {
        for (const glm::vec3& place : {glm::vec3(0.0f), glm::vec3(1.0f, -2.0f, 3.0f)}) {
            TriangleMesh mesh = cube_mesh(1.0f);
            for (glm::vec3& p : mesh.positions) p = place;
            for (const MeshBoxes boxes :
                 {MeshBoxes::principal_axes, MeshBoxes::small_perimeter, MeshBoxes::least_perimeter}) {
                const MeshTree tree = MeshTree::build(mesh, {.boxes = boxes}).value();
                REQUIRE(tree.pieces()[0].closed);
                CHECK(contains(tree, glm::dvec3(place)));
                CHECK_FALSE(contains(tree, glm::dvec3(place) + glm::dvec3(0.0, 0.0, 1e-9)));
            }
        }
    }

    TEST_CASE("the depth is the shortest way out, of the directions tried") {
        const auto a = tree_of(cube_mesh(1.0f)), b = tree_of(cube_mesh(0.5f));
        const SeparatingMotion side = separating_motion(a, b, {glm::dmat3(1.0), {1.3, 0.1, 0.0}}, {});
        CHECK(side.depth == doctest::Approx(0.2).epsilon(1e-4));
        CHECK(side.direction.x == doctest::Approx(1.0));
        CHECK(separating_motion(a, b, {glm::dmat3(1.0), {0.1, 0.0, 0.0}}, {}).depth ==
              doctest::Approx(1.4).epsilon(1e-4));
        CHECK(separating_motion(a, b, {glm::dmat3(1.0), {1.6, 0.1, 0.0}}, {}).depth == 0.0);
    }

    TEST_CASE("penetration separates coincident points by the rounding of their coordinates") {
        TriangleMesh point;
        point.positions.assign(3, glm::vec3(1.0f, 2.0f, 3.0f));
        point.indices = {0, 1, 2};
        const auto a = tree_of(point);
        const SeparatingMotion depth = separating_motion(a, a, {}, {});
        CHECK(glm::length(depth.direction) == doctest::Approx(1.0));
        CHECK(depth.depth < 1e-11);
        CHECK_FALSE(intersects(a, a, {glm::dmat3(1.0), depth.depth * depth.direction}));
    }
}
