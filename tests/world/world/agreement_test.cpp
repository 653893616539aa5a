// SPDX-License-Identifier: MIT
// What different calls of a World say of the same objects agrees: on a grid of integers, where ties are the rule and
// every answer can be told exactly.
#include <doctest/doctest.h>
#include <crofton/convex/query.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <limits>
#include <oracle/near_misses.hpp>
#include <set>
#include <shape/mesh/meshes.hpp>
#include <vector>

#include "cubes.hpp"

using namespace crofton;
using namespace crofton::testing;
using oracle::NearMisses;

namespace {

glm::dvec3 grid_point(NearMisses& random, int reach) {
    const auto number = [&] { return static_cast<double>(random.index(2 * static_cast<unsigned>(reach) + 1)) - reach; };
    const double x = number(), y = number(), z = number();
    return {x, y, z};
}

// A scale of 0 in an axis or two, half of the time.
Transform grid_transform(NearMisses& random) {
    Transform result;
    result.translation = grid_point(random, 4);
    const unsigned turn = random.index(3);
    for (unsigned k = 0; k < 3; ++k) {
        result.linear[static_cast<int>(k)] = glm::dvec3(0.0);
        result.linear[static_cast<int>(k)][static_cast<int>((k + turn) % 3)] = random.index(2) == 0 ? 1.0 : -2.0;
    }
    for (int flat = static_cast<int>(random.index(4)); flat >= 2; --flat)
        result.linear[static_cast<int>(random.index(3))] *= 0.0;
    return result;
}

}  // namespace

TEST_SUITE("world/agreement") {
    TEST_CASE(
        "rays meet the triangles of meshes under any scale, also a flat one, and the nearest is the first of all") {
        NearMisses random(4601);
        const TriangleMesh crate = box_mesh(glm::vec3(-1.0f), glm::vec3(1.0f));
        int flat_hits = 0, ties = 0;
        for (int round = 0; round < 200; ++round) {
            World world;
            const auto mesh = world.add_mesh(described(crate)).value();
            std::vector<Transform> places;
            for (int i = 0; i < 12; ++i) {
                places.push_back(grid_transform(random));
                REQUIRE(world.add({.mesh = mesh, .transform = places.back()}).has_value());
            }
            REQUIRE(world.update().has_value());
            for (int k = 0; k < 40; ++k) {
                glm::dvec3 way = grid_point(random, 2);
                if (way == glm::dvec3(0.0)) way.x = 1.0;
                const Ray ray{grid_point(random, 7), way};
                CAPTURE(round);
                CAPTURE(k);
                Vector<ObjectHit> all;
                world.raycast_all(ray, all);
                std::size_t next = 0;
                for (std::uint32_t i = 0; i < places.size(); ++i) {
                    double t = std::numeric_limits<double>::infinity();
                    for (std::size_t c = 0; c < crate.indices.size(); c += 3) {
                        Triangle corners;
                        for (std::size_t v = 0; v < 3; ++v)
                            corners[v] = places[i] * glm::dvec3(crate.positions[crate.indices[c + v]]);
                        if (const auto hit = mesh::raycast(ray, corners)) t = std::min(t, *hit);
                    }
                    const auto found = std::find_if(all.begin(), all.end(),
                                                    [&](const ObjectHit& hit) { return hit.object.index == i; });
                    CHECK((found != all.end()) == (t < HUGE_VAL));
                    if (found == all.end()) continue;
                    ++next;
                    CHECK(found->t == doctest::Approx(t).epsilon(1e-12));
                    CHECK(found->triangle < 12);
                    CHECK(!found->started_inside);
                    CHECK(glm::length(found->normal) == doctest::Approx(1.0));
                    CHECK(glm::dot(found->normal, way) < 0.0);
                    flat_hits += glm::determinant(places[i].linear) == 0.0;
                }
                CHECK(next == all.size());
                const auto nearest = world.raycast(ray);
                REQUIRE(nearest.has_value() == !all.empty());
                CHECK(world.raycast_any(ray) == !all.empty());
                if (!nearest) continue;
                CHECK(nearest->object == all[0].object);
                CHECK(nearest->t == all[0].t);
                CHECK(nearest->triangle == all[0].triangle);
                ties += all.size() > 1 && all[0].t == all[1].t;
            }
        }
        CHECK(flat_hits > 300);
        CHECK(ties > 100);
    }

    TEST_CASE("hits are in order of their points also if the direction is so short that their t is infinite") {
        World world;
        for (const double x : {30.0, 20.0, 10.0}) REQUIRE(world.add({.bound = Sphere{{x, 0.0, 0.0}, 1.0}}).has_value());
        REQUIRE(world.update().has_value());
        const Ray ray{{0.0, 0.0, 0.0}, {1e-310, 0.0, 0.0}};
        Vector<ObjectHit> all;
        world.raycast_all(ray, all);
        REQUIRE(all.size() == 3);
        for (std::size_t i = 0; i < 3; ++i)
            CHECK(all[i].point.x == doctest::Approx(9.0 + 10.0 * static_cast<double>(i)));
        CHECK(world.raycast(ray)->object == all[0].object);
    }

    TEST_CASE("a mesh inside a box or a sphere touches it, as overlap() says, whether closed meshes contain or not") {
        TriangleMesh open = box_mesh(glm::vec3(-1.0f), glm::vec3(1.0f));
        for (const bool is_open : {false, true}) {
            if (is_open) open.indices.resize(30);
            for (const bool containment : {false, true})
                for (const Bound& bound : {Bound(Obb{{}, glm::mat3(1.0f), glm::vec3(3.0f)}), Bound(Sphere{{}, 4.0})}) {
                    World world({.containment = containment});
                    const auto mesh = world.add_mesh(described(open)).value();
                    const ObjectHandle first = world.add({.bound = bound}).value();
                    const ObjectHandle second = world.add({.mesh = mesh, .transform = Transform{}}).value();
                    REQUIRE(world.update().has_value());
                    CHECK(world.contacts().size() == 1);
                    Vector<ObjectRef> found;
                    if (bound.kind == BoundKind::sphere)
                        world.overlap(Sphere{{}, 4.0}, found);
                    else
                        world.overlap(bound.box, found);
                    CHECK(found.size() == 2);
                    // A small box in the mesh: only as the option says.
                    REQUIRE(
                        world.set_bound(first, Obb{{0.5, 0.0, 0.0}, glm::mat3(1.0f), glm::vec3(0.25f)}).has_value());
                    REQUIRE(world.update().has_value());
                    const bool touches = containment && !is_open;
                    REQUIRE(world.contacts().size() == 1);
                    CHECK((world.contacts()[0].phase == ContactPhase::ended) == !touches);
                    CHECK(world.contains(second));
                }
        }
    }

    TEST_CASE("a contact goes on if its objects gain or lose shapes, and is listed once") {
        const auto ball = convex::Shape::sphere(1.0).value();
        const auto level = convex::Shape::half_space({{0.0, -1.0, 0.0}, 0.25}).value();
        for (const convex::Shape& other : {ball, level}) {
            World world;
            const Obb box{{}, glm::mat3(1.0f), glm::vec3(1.0f)};
            const ObjectHandle a = world.add({.bound = box}).value(), b = world.add({.bound = box}).value();
            const auto phase = [&] {
                REQUIRE(world.update().has_value());
                REQUIRE(world.contacts().size() == 1);
                return world.contacts()[0].phase;
            };
            CHECK(phase() == ContactPhase::began);
            REQUIRE(world.set_shape(a, &ball).has_value());
            CHECK(phase() == ContactPhase::stayed);
            REQUIRE(world.set_shape(b, &other).has_value());
            CHECK(phase() == ContactPhase::stayed);
            CHECK(!world.contacts()[0].shape_points.empty());
            CHECK(phase() == ContactPhase::stayed);
            REQUIRE(world.set_shape(a, nullptr).has_value());
            CHECK(phase() == ContactPhase::stayed);
            CHECK(world.contacts()[0].shape_points.empty());
            REQUIRE(world.set_shape(b, nullptr).has_value());
            CHECK(phase() == ContactPhase::stayed);
            REQUIRE(world.remove(b).has_value());
            CHECK(phase() == ContactPhase::ended);
            REQUIRE(world.update().has_value());
            CHECK(world.contacts().empty());
        }
    }
}
