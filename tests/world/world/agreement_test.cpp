// SPDX-License-Identifier: MIT
// What different calls of a World say of the same objects agrees: on a grid of integers, where ties are the rule and
// every answer can be told exactly.
#include <doctest/doctest.h>
#include <array>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <limits>
#include <optional>
#include <oracle/near_misses.hpp>
#include <oracle/random_boxes.hpp>
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

    TEST_CASE("the nearest object is found within its own distance, and within no less, by any probe") {
        NearMisses random(4603);
        const auto cone = convex::Shape::cone(0.75f, 0.5f).value(),
                   ground = convex::Shape::half_space({{0, -1, 0}, -30}).value();
        const TriangleMesh cube = testing::box_mesh(glm::vec3(-1.0f), glm::vec3(1.0f));
        int apart = 0;
        for (const double far : {0.0, 1e4, 1e7}) {
            World world;
            const MeshHandle mesh = world.add_mesh(described(cube)).value();
            for (int i = 0; i < 16; ++i) {
                const glm::dvec3 place = far + 8.0 * random.vector(-1, 1);
                const glm::dmat3 axes(oracle::random_box(random, {}, 1.0).axes);
                ObjectDescription thing{.transform = Transform{axes, place}};
                if (i % 4 == 0) thing = {.bound = Obb{place, glm::mat3(axes), {0.5f, 1.0f, 0.25f}}};
                if (i % 4 == 1) thing = {.bound = Sphere{place, random.number(0.1, 1.0)}};
                if (i % 4 == 2) thing.mesh = mesh, thing.transform->linear[0] *= i % 8 == 2 ? 1.0 : 1.5;
                if (i % 4 == 3) thing.shape = &cone;
                REQUIRE(world.add(thing).has_value());
            }
            if (far == 1e4) REQUIRE(world.add({.shape = &ground}).has_value());
            REQUIRE(world.update().has_value());
            for (int i = 0; i < 400; ++i) {
                CAPTURE(i);
                const glm::dvec3 place = far + 12.0 * random.vector(-1, 1);
                const RigidTransform pose{glm::dmat3(oracle::random_box(random, {}, 1.0).axes), place};
                const auto within = [&](double distance) {
                    if (i % 4 == 0)
                        return world.closest(Obb{place, glm::mat3(pose.rotation), glm::vec3(0.25f)}, distance);
                    if (i % 4 == 1) return world.closest(Sphere{place, 0.3}, distance);
                    if (i % 4 == 2) return world.closest(collide::Capsule{place, place + 1.0, 0.1}, distance);
                    return world.closest(cone, pose, distance);
                };
                const auto nearest = within(1e9);
                REQUIRE(nearest.has_value());
                const auto again = within(nearest->distance);
                REQUIRE(again.has_value());
                CHECK(again->object == nearest->object);
                CHECK(again->distance == nearest->distance);
                CHECK(!std::signbit(nearest->distance));
                if (nearest->distance == 0.0) continue;
                ++apart;
                CHECK(!within(std::nextafter(nearest->distance, 0.0)));
            }
        }
        CHECK(apart > 800);
    }

    TEST_CASE("no t of a ray, and no time or distance of a cast, is -0") {
        NearMisses random(4604);
        const TriangleMesh cube = testing::box_mesh(glm::vec3(-1.0f), glm::vec3(1.0f));
        const mesh::MeshTree tree = mesh::MeshTree::build(cube, {.rays = true}).value();
        const std::array children{
            convex::CompoundChild{convex::Shape::sphere(1.0).value(), {glm::dmat3(1.0), {1, 0, 0}}},
            convex::CompoundChild{convex::Shape::box(glm::vec3(1.0f)).value(), {}}};
        const convex::Compound compound = convex::Compound::build(children).value();
        const std::array shapes{convex::Shape::sphere(1.0).value(),
                                convex::Shape::capsule(1, 1).value(),
                                convex::Shape::cylinder(1, 1).value(),
                                convex::Shape::cone(1, 1).value(),
                                children[1].shape,
                                convex::Shape::mesh(tree).value(),
                                convex::Shape::compound(compound),
                                convex::Shape::half_space({{0, -1, 0}, -1}).value()};
        const auto signed_grid = [&](int reach) {
            glm::dvec3 point = grid_point(random, reach);
            for (int k = 0; k < 3; ++k)
                if (point[k] == 0.0 && random.index(2) == 0) point[k] = -0.0;
            return point;
        };
        const auto is_good = [](double value) { return value != 0.0 || !std::signbit(value); };
        int at_zero = 0;
        for (int i = 0; i < 6000; ++i) {
            CAPTURE(i);
            const convex::Shape& shape = shapes[random.index(8)];
            const RigidTransform pose{glm::dmat3(1.0), signed_grid(2)}, from{glm::dmat3(1.0), signed_grid(3)};
            const double end = std::array{HUGE_VAL, 1.0, 0.0, -0.0}[random.index(4)];
            const Ray ray{from.translation, signed_grid(2), end};
            World world;
            if (i % 4 != 0) {
                REQUIRE(world.add({.transform = Transform{glm::dmat3(1.0), pose.translation}, .shape = &shape})
                            .has_value());
            } else {
                const MeshHandle mesh = world.add_mesh(described(cube)).value();
                REQUIRE(
                    world.add({.mesh = mesh, .transform = Transform{glm::dmat3(1.0), pose.translation}}).has_value());
            }
            REQUIRE(world.update().has_value());
            if (const auto hit = convex::raycast({shape, pose}, ray)) {
                CHECK(is_good(hit->t));
                at_zero += hit->t == 0.0;
            }
            if (const auto hit = world.raycast(ray)) CHECK(is_good(hit->t));
            const std::array<Ray, 4> rays{ray, ray, ray, ray};
            std::array<std::optional<mesh::TriangleHit>, 4> hits;
            mesh::raycast(rays, tree, hits);
            for (const auto& hit : hits)
                if (hit) CHECK(is_good(hit->t));
            if (const auto hit = mesh::raycast(ray, tree)) CHECK(is_good(hit->t));
            convex::CastOptions options{.duration = end == HUGE_VAL ? 1.0 : end};
            options.early_out = random.index(4) == 0 ? -0.0 : HUGE_VAL;
            const convex::Shape& mover = shapes[random.index(7)];
            const auto met = convex::cast({mover, from}, {signed_grid(4)}, {shape, pose}, {}, options);
            REQUIRE(met.has_value());
            CHECK(is_good(met->time));
            CHECK(is_good(met->distance));
            const auto hit = world.cast(mover, from, {signed_grid(4)}, options);
            REQUIRE(hit.has_value());
            if (*hit) CHECK(is_good((*hit)->time));
            if (*hit) CHECK(is_good((*hit)->distance));
        }
        CHECK(at_zero > 300);
    }
}
