// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/occlude/occluder.hpp>
#include <error_of.hpp>
#include <limits>
#include <shared_mesh.hpp>
#include <string>

#include "view/occlude/found_bodies.hpp"

using namespace crofton;
using namespace crofton::occlude;
using namespace crofton::testing;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::size_t bodies_of(const FoundOccluders& found) {
    return found.occluders.size() - count_of(found, OccluderKind::patch);
}

}  // namespace

TEST_SUITE("occlude/find_occluders") {
    TEST_CASE("bad options, indices and meshes without triangles are named") {
        const TriangleMesh cube = box_mesh(glm::vec3(0), glm::vec3(1));
        CHECK(error_of(find_occluders(TriangleMesh{})).code == ErrorCode::empty);
        CHECK(error_of(find_occluders(cube, {.grid = 3})).code == ErrorCode::out_of_range);
        CHECK(error_of(find_occluders(cube, {.grid = 33})).code == ErrorCode::out_of_range);
        CHECK(error_of(find_occluders(cube, {.least_gain = -0.1})).code == ErrorCode::out_of_range);
        CHECK(error_of(find_occluders(cube, {.flatness = double(kNan)})).code == ErrorCode::out_of_range);
        CHECK(error_of(find_occluders(cube, {.least_gain = 1.5})).code == ErrorCode::out_of_range);
        CHECK(error_of(find_occluders(cube, {.flatness = 1.5})).code == ErrorCode::out_of_range);
        TriangleMesh ragged = cube;
        ragged.indices.pop_back();
        CHECK(error_of(find_occluders(ragged)).code == ErrorCode::invalid_argument);
        TriangleMesh lost = cube;
        for (glm::vec3& p : lost.positions) p.y = kNan;
        CHECK(error_of(find_occluders(lost)).code == ErrorCode::empty);
    }

    TEST_CASE("a triangle with a bad corner or index is listed, and opens its piece alone") {
        for (const glm::vec3 bad : {glm::vec3(kNan, 0, 0), glm::vec3(0, std::numeric_limits<float>::infinity(), 0),
                                    glm::vec3(-2e12f, 0, 0), glm::vec3(0, 0, 2e12f)}) {
            TriangleMesh mesh = box_mesh(glm::vec3(0), glm::vec3(1));
            append(mesh, box_mesh(glm::vec3(3), glm::vec3(4)));
            mesh.positions.push_back(bad);
            mesh.indices[1] = 16;
            mesh.indices.insert(mesh.indices.end(), {0, 1, 99});
            const FoundOccluders found = found_in(mesh);
            REQUIRE(found.rejected.size() == 2);
            CHECK(found.rejected[0] == 0);
            CHECK(found.rejected[1] == 24);
            CHECK(found.closed_pieces == 1);
            CHECK(count_of(found, OccluderKind::convex) == 1);
            std::mt19937_64 random(1);
            check_found(mesh, found, Sides::front, random);
        }
    }

    TEST_CASE("a cube is its own occluder, with twelve edges and a mean shadow of F/4") {
        const TriangleMesh cube = box_mesh(glm::vec3(0), glm::vec3(2));
        const FoundOccluders found = found_in(cube);
        REQUIRE(found.occluders.size() == 1);
        const FoundOccluder& o = found.occluders[0];
        CHECK(o.kind == OccluderKind::convex);
        CHECK(o.edges == 12);
        CHECK(o.mean_shadow == doctest::Approx(6.0));
        CHECK(o.surface.indices.size() == 36);
        CHECK(found.share() == doctest::Approx(1.0));
        CHECK(found.mean_shadow == doctest::Approx(6.0).epsilon(0.03));
        CHECK(o.piece_bounds.min == glm::dvec3(0.0));
        CHECK(o.piece_bounds.max == glm::dvec3(2.0));
    }

    TEST_CASE("a cube that is inside out has no body where back faces are culled, and one where they are drawn") {
        const TriangleMesh cube = turned_inside_out(box_mesh(glm::vec3(0), glm::vec3(2)));
        CHECK(bodies_of(found_in(cube)) == 0);
        const FoundOccluders both = found_in(cube, {.sides = Sides::both});
        REQUIRE(both.occluders.size() == 1);
        CHECK(both.occluders[0].kind == OccluderKind::convex);
        CHECK(sign_of_volume(both.occluders[0].surface) > 0);
    }

    TEST_CASE("an open cube has no body inside, but one behind its five walls, and patches") {
        TriangleMesh cube = box_mesh(glm::vec3(0), glm::vec3(2));
        cube.indices.resize(cube.indices.size() - 3);
        const FoundOccluders found = found_in(cube);
        CHECK(found.closed_pieces == 0);
        CHECK(count_of(found, OccluderKind::box) + count_of(found, OccluderKind::convex) == 0);
        CHECK(count_of(found, OccluderKind::patch) == 6);
        REQUIRE(count_of(found, OccluderKind::walled) == 1);
        CHECK(found.occluders[0].eyes_within.max == glm::dvec3(everywhere().max.x, everywhere().max.y, 2.0));
        CHECK(found.occluders[0].eyes_within.min == everywhere().min);
        std::mt19937_64 random(2);
        check_found(cube, found, Sides::front, random);
    }

    TEST_CASE("one triangle is a patch that hides from its front, or from both sides") {
        TriangleMesh mesh;
        mesh.positions = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
        mesh.indices = {0, 1, 2};
        const FoundOccluders front = found_in(mesh), both = found_in(mesh, {.sides = Sides::both});
        REQUIRE(front.occluders.size() == 1);
        REQUIRE(both.occluders.size() == 1);
        CHECK(front.occluders[0].mean_shadow == doctest::Approx(0.5));
        CHECK(both.occluders[0].mean_shadow == doctest::Approx(1.0));
        CHECK(front.occluders[0].sides == Sides::front);
        CHECK(both.occluders[0].sides == Sides::both);
        CHECK(front.occluders[0].edges == 3);
    }

    TEST_CASE("triangles without area throw no shadow") {
        TriangleMesh mesh;
        mesh.positions = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
        mesh.indices = {0, 1, 2, 0, 0, 1, 2, 2, 2};
        CHECK(found_in(mesh).occluders.empty());
        CHECK(found_in(mesh, {.sides = Sides::both}).occluders.empty());
    }

    TEST_CASE("an L is hidden behind by two boxes that reach its walls") {
        const TriangleMesh mesh = l_shape();
        std::mt19937_64 random(3);
        // Bodies alone, whatever patches would add: the boxes are [0, 10] × [0, 3] and [0, 3] × [0, 8], 4 deep.
        const FoundOccluders found = found_in(mesh, {.max_edges = 24});
        check_found(mesh, found, Sides::front, random);
        REQUIRE(found.occluders.size() == 2);
        REQUIRE(bodies_of(found) == 2);
        CHECK(found.occluders[0].mean_shadow == doctest::Approx((30 + 12 + 40) / 2.0).epsilon(1e-5));
        CHECK(found.occluders[1].mean_shadow == doctest::Approx((24 + 12 + 32) / 2.0).epsilon(1e-5));
        CHECK(found.share() > 0.95);
    }

    TEST_CASE("in a sphere the box is nearly the cube of its size") {
        std::mt19937_64 random(4);
        const TriangleMesh sphere = sphere_mesh(48, 24);
        const FoundOccluders found = found_in(sphere, {.max_occluders = 1, .max_edges = 12});
        REQUIRE(bodies_of(found) == 1);
        check_found(sphere, found, Sides::front, random);
        // The greatest surface of a box in the unit sphere is the cube's, 24/3: F/4 = 2. The mesh is a little less.
        CHECK(found.occluders[0].mean_shadow > 1.8);
        CHECK(found.occluders[0].mean_shadow < 2.0);
    }

    TEST_CASE("no box fills the hole of a torus") {
        std::mt19937_64 random(5);
        const TriangleMesh torus = wavy_torus(3.0, 1.0, 0.1);
        const FoundOccluders found = found_in(torus);
        CHECK(count_of(found, OccluderKind::box) >= 2);
        check_found(torus, found, Sides::front, random);
    }

    TEST_CASE("boxes in random stars are inside by exact arithmetic, in every pose, at every size and place") {
        std::mt19937_64 random(6);
        int boxes = 0;
        for (int trial = 0; trial < 24; ++trial) {
            const TriangleMesh shape = star(random, 0.3, 9, 7);
            const double scale = std::pow(10.0, std::array{-20.0, 0.0, 3.0, 8.0}[std::size_t(trial % 4)]);
            const glm::dvec3 offset =
                trial % 3 == 0 ? glm::dvec3(0.0) : random_vector(random) * (trial % 3 == 1 ? 30.0 : 1e3);
            const glm::dmat3 turn = glm::dmat3(glm::mat3_cast(random_rotation(random)));
            const TriangleMesh mesh = moved(shape, turn * scale, offset * scale);
            const Sides sides = trial % 2 == 0 ? Sides::front : Sides::both;
            const FoundOccluders found = found_in(mesh, {.sides = sides, .grid = trial % 5 == 0 ? 32u : 12u});
            check_found(mesh, found, sides, random, 4);
            boxes += static_cast<int>(count_of(found, OccluderKind::box));
        }
        CHECK(boxes > 24);
    }

    TEST_CASE("vertices snapped to a coarse lattice, 10,000,000 from the origin, leave smaller boxes inside") {
        std::mt19937_64 random(7);
        int boxes = 0;
        for (int trial = 0; trial < 20; ++trial) {
            const glm::dmat3 turn = glm::dmat3(glm::mat3_cast(random_rotation(random)));
            const TriangleMesh mesh =
                moved(trial % 2 ? l_shape() : star(random, 0.6, 8, 6), turn * 12.0, glm::dvec3(1e7, -1e7, 3e6));
            const FoundOccluders found = found_in(mesh);
            check_found(mesh, found, Sides::front, random, 6);
            boxes += static_cast<int>(count_of(found, OccluderKind::box));
        }
        CHECK(boxes > 10);
    }

    TEST_CASE("boxes in meshes that cross themselves lie where the surface winds round") {
        std::mt19937_64 random(8);
        for (int trial = 0; trial < 10; ++trial) {
            TriangleMesh mesh = star(random, 0.4, 8, 6);
            for (glm::vec3& p : mesh.positions) p += glm::vec3(0.35 * random_vector(random));
            for (const Sides sides : {Sides::front, Sides::both})
                check_found(mesh, found_in(mesh, {.sides = sides}), sides, random, 10);
        }
    }

    TEST_CASE("faces given twice: wound twice round, or both ways and then nothing is inside") {
        std::mt19937_64 random(9);
        TriangleMesh twice = l_shape();
        append(twice, l_shape());
        const FoundOccluders wound = found_in(twice);
        CHECK(bodies_of(wound) >= 1);
        check_found(twice, wound, Sides::front, random);
        CHECK(bodies_of(found_in(twice, {.sides = Sides::both})) == 0);  // rays cross it four times: an even number
        TriangleMesh both_ways = l_shape();
        append(both_ways, turned_inside_out(l_shape()));
        CHECK(bodies_of(found_in(both_ways)) == 0);
        CHECK(bodies_of(found_in(both_ways, {.sides = Sides::both})) == 0);
    }

    TEST_CASE("boxes that share a corner or an edge are each found") {
        TriangleMesh corner = box_mesh(glm::vec3(0), glm::vec3(1));
        append(corner, box_mesh(glm::vec3(1), glm::vec3(2)));
        CHECK(count_of(found_in(corner), OccluderKind::convex) == 2);
        TriangleMesh edge = box_mesh(glm::vec3(0), glm::vec3(1));
        append(edge, box_mesh({1, 1, 0}, {2, 2, 1}));
        const FoundOccluders found = found_in(edge);
        CHECK(bodies_of(found) == 2);
        std::mt19937_64 random(10);
        check_found(edge, found, Sides::front, random);
    }

    TEST_CASE("a wall with windows is one patch with its holes, whatever way its triangles are stored") {
        // A ring of quads around a hole, corners not shared by index.
        TriangleMesh wall;
        const auto quad = [&](glm::vec2 a, glm::vec2 b) {
            const auto first = static_cast<std::uint32_t>(wall.positions.size());
            for (const glm::vec2& p : {a, glm::vec2(b.x, a.y), b, glm::vec2(a.x, b.y)})
                wall.positions.push_back({p, 5.0f});
            for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) wall.indices.push_back(first + i);
        };
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                if (i != 1 || j != 1) quad({i, j}, {i + 1, j + 1});
        CHECK(found_in(wall).occluders.empty());  // of too many triangles
        const FoundOccluders found = found_in(wall, {.max_patch_triangles = 16});
        REQUIRE(found.occluders.size() == 1);
        CHECK(found.occluders[0].kind == OccluderKind::patch);
        CHECK(found.occluders[0].surface.triangle_count() == 16);
        CHECK(found.occluders[0].edges == 16);  // twelve around, four of the hole
        CHECK(found.occluders[0].mean_shadow == doctest::Approx(2.0));
        std::mt19937_64 random(11);
        check_found(wall, found, Sides::front, random);
    }

    TEST_CASE("pieces, shadows and gains of bodies far apart are those of each") {
        TriangleMesh mesh = box_mesh(glm::vec3(0), glm::vec3(2));
        append(mesh, box_mesh(glm::vec3(50, 0, 0), glm::vec3(51, 1, 1)));
        mesh.positions.insert(mesh.positions.end(), {{0, 0, 50}, {4, 0, 50}, {4, 4, 50}, {0, 4, 50}});
        mesh.indices.insert(mesh.indices.end(), {16, 17, 18, 16, 18, 19});
        const FoundOccluders found = found_in(mesh, {.sides = Sides::both, .least_gain = 0.001});
        CHECK(found.pieces == 3);
        CHECK(found.closed_pieces == 2);
        REQUIRE(found.occluders.size() == 3);
        // F/4 of cubes of side 2 and 1, A/2 of the square.
        double sum = 0.0;
        for (const FoundOccluder& each : found.occluders) {
            const double shadow = each.kind == OccluderKind::patch ? 8.0 : each.piece_bounds.min.x > 10.0 ? 1.5 : 6.0;
            CHECK(each.mean_shadow == doctest::Approx(shadow));
            CHECK(each.gain == doctest::Approx(shadow).epsilon(0.1));
            sum += each.gain;
        }
        CHECK(found.covered == doctest::Approx(sum));
        CHECK(found.mean_shadow == doctest::Approx(15.5).epsilon(0.1));
    }

    TEST_CASE("the budgets hold, and what comes first gains most for its edges") {
        std::mt19937_64 random(12);
        TriangleMesh mesh;
        for (int i = 0; i < 40; ++i) {
            const glm::vec3 low = glm::vec3(20.0 * random_vector(random));
            append(mesh, box_mesh(low, low + glm::vec3(3) + glm::vec3(glm::abs(random_vector(random)))));
        }
        const FoundOccluders found = found_in(mesh, {.max_occluders = 7, .least_gain = 0.001});
        CHECK(found.occluders.size() == 7);
        for (std::size_t i = 1; i < 7; ++i) CHECK(found.occluders[i].gain <= found.occluders[i - 1].gain);
        CHECK(found_in(mesh, {.max_edges = 60, .least_gain = 0.001}).occluders.size() == 5);
        CHECK(found_in(mesh, {.max_occluders = 0}).occluders.empty());
    }

    TEST_CASE("boxes in scanned and modelled meshes of the shared data are inside by exact arithmetic") {
        std::mt19937_64 random(16);
        for (const char* name : {"cow", "fandisk", "homer", "spider", "suzanne", "teapot", "woody", "wuson"}) {
            const TriangleMesh mesh = shared_mesh(name);
            if (mesh.indices.empty()) continue;  // no shared data
            CAPTURE(name);
            for (const Sides sides : {Sides::front, Sides::both})
                check_found(mesh, found_in(mesh, {.sides = sides}), sides, random, 1);
        }
    }

    TEST_CASE("half a million slivers end in time and leave no box outside") {
        std::mt19937_64 random(13);
        TriangleMesh mesh = box_mesh(glm::vec3(-1), glm::vec3(1));
        for (int i = 0; i < 500'000; ++i) {
            const auto first = static_cast<std::uint32_t>(mesh.positions.size());
            const glm::vec3 p = glm::vec3(random_vector(random)), q = glm::vec3(random_vector(random));
            mesh.positions.insert(mesh.positions.end(),
                                  {p, q, p + 0.5f * (q - p) + glm::vec3(1e-7 * random_vector(random))});
            mesh.indices.insert(mesh.indices.end(), {first, first + 1, first + 2});
        }
        const FoundOccluders found = found_in(mesh);
        REQUIRE(found.occluders.size() >= 1);
        CHECK(found.occluders[0].kind == OccluderKind::convex);
    }
}
