// SPDX-License-Identifier: MIT
// World::cast: the point, the normal and the distance of what is met first, and casts that begin in contact.
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <crofton/crofton.hpp>
#include <glm/geometric.hpp>
#include <oracle/impacts.hpp>
#include <vector>

#include "../../shape/convex/surfaces.hpp"
#include "shape_pose.hpp"

using namespace crofton;
using namespace crofton::testing;

namespace {

Obb box_around(const convex::Shape& shape, const RigidTransform& pose) {
    const glm::dvec3 half = glm::max(glm::abs(shape.bounds().min), glm::abs(shape.bounds().max)) * 1.000001;
    return {pose.translation, glm::mat3(pose.rotation), glm::vec3(half)};
}

}  // namespace

TEST_SUITE("world/shape_cast") {
    TEST_CASE("the point of a hit lies on the object, where the mover touches it, and the normal parts them") {
        RandomShapes random(81);
        int hits = 0;
        for (int round = 0; round < 1500; ++round) {
            World world;
            const convex::Shape target = any_shape(random), mover = any_shape(random);
            const Obb box = box_around(target, {random.rotation(), 2.0 * random.direction()});
            const int kind = round % 3;  // a shape, the box, a sphere
            const double radius = random.number(0.2, 1);
            const ObjectHandle object =
                (kind == 2 ? world.add({.bound = Sphere{box.center, radius}}) : world.add({.bound = box})).value();
            if (kind == 0) REQUIRE(world.set_shape(object, &target).has_value());
            REQUIRE(world.update().has_value());
            const RigidTransform from{random.rotation(), box.center + 5.0 * random.direction()};
            const convex::Motion fly{1.4 * (box.center - from.translation) + random.direction(),
                                     random.index(2) * 3.0 * random.direction(),
                                     {}};
            const auto hit = world.cast(mover, from, fly, {}).value();
            if (!hit) continue;
            ++hits;
            CHECK(hit->object == object);
            CHECK(hit->distance >= 0.0);
            CHECK(hit->distance < 1e-6);
            const convex::Shape bound =
                kind == 2 ? convex::Shape::sphere(radius).value() : convex::Shape::box(box.half_extents).value();
            const RigidTransform stand = pose_of(box), then = convex::moved(from, fly, hit->time);
            convex::Impact impact;
            impact.normal = hit->normal;
            impact.on_b = hit->point;
            impact.on_a = hit->point - hit->distance * hit->normal;
            impact.distance = hit->distance;
            const std::string fault =
                oracle::fault_of_contact({mover, then}, {kind == 0 ? target : bound, stand}, impact, 4e-8);
            CHECK(fault == "");
        }
        CHECK(hits > 1000);
    }

    TEST_CASE("a mover that stops at an object slides along it and flies away, and presses on it at once") {
        RandomShapes random(82);
        int hits = 0;
        for (int round = 0; round < 600; ++round) {
            World world;
            const convex::Shape target = any_shape(random), mover = any_shape(random);
            const Obb box = box_around(target, {random.rotation(), 2.0 * random.direction()});
            const ObjectHandle object = world.add({.bound = box}).value();
            if (round % 2 == 0) REQUIRE(world.set_shape(object, &target).has_value());
            REQUIRE(world.update().has_value());
            RigidTransform pose{random.rotation(), box.center + 5.0 * random.direction()};
            const convex::Motion fly{1.4 * (box.center - pose.translation), {}, {}};
            const auto hit = world.cast(mover, pose, fly, {}).value();
            if (!hit) continue;
            ++hits;
            pose = convex::moved(pose, fly, hit->time);
            const glm::dvec3 n = hit->normal, side = glm::normalize(glm::cross(n, random.direction()));
            CHECK_FALSE(world.cast(mover, pose, {-2.0 * n, {}, {}}, {}).value().has_value());
            CHECK_FALSE(world.cast(mover, pose, {3.0 * side, {}, {}}, {}).value().has_value());
            const auto in = world.cast(mover, pose, {2.0 * n + side, {}, {}}, {}).value();
            REQUIRE(in.has_value());
            CHECK(in->time == 0.0);
            CHECK(std::abs(in->distance - hit->distance) < 1e-8);
            CHECK(glm::dot(in->normal, n) > 1.0 - 1e-6);
            const convex::CastOptions without{.ignore_initial_overlaps = true};
            CHECK_FALSE(world.cast(mover, pose, {2.0 * n, {}, {}}, without).value().has_value());
        }
        CHECK(hits > 300);
    }

    TEST_CASE(
        "of many objects the hit is the first, with its handle, user and triangle, and says what is not resolved") {
        RandomShapes random(83);
        const Surface soup_of_triangles = soup(random, 60, 1.0, 0.4);
        const convex::Shape mesh = soup_of_triangles.shape();
        int hits = 0, at_triangles = 0, unresolved = 0;
        for (int round = 0; round < 600; ++round) {
            World world;
            std::vector<ObjectHandle> objects;
            std::vector<convex::Shape> shapes;
            std::vector<RigidTransform> poses;
            for (int i = 0; i < 12; ++i) {
                shapes.push_back(i % 3 == 0 ? mesh : any_shape(random));
                const glm::dmat3 turn = random.rotation();
                const glm::dvec3 place(4.0 * (i % 4), 4.0 * (i / 4), random.number(-1, 1));
                poses.push_back({turn, place});
                const Transform transform{turn, place};
                objects.push_back(
                    world.add({.transform = transform, .shape = &shapes.back(), .user = 100u + std::uint64_t(i)})
                        .value());
            }
            REQUIRE(world.update().has_value());
            const convex::Shape mover = any_shape(random, 0.5);
            const double goal_x = random.number(0, 12), goal_y = random.number(0, 8);
            const glm::dvec3 goal(goal_x, goal_y, 0.0);
            const glm::dvec3 start = goal + 9.0 * random.direction();
            const RigidTransform from{random.rotation(), start};
            const double turning = 4.0 * random.index(2);
            const glm::dvec3 spin = turning * random.direction();
            const convex::Motion fly{1.8 * (goal - start), spin, {}};
            convex::CastOptions options;
            if (round % 4 == 3) options.max_steps = 1 + random.index(3);
            const auto hit = world.cast(mover, from, fly, options).value();
            if (hit && !hit->resolved) {
                // What the steps were not enough for: nothing is met up to that time.
                ++unresolved;
                CHECK(round % 4 == 3);
                for (int k = 0; k < 8; ++k) {
                    const RigidTransform before = convex::moved(from, fly, hit->time * k / 8.0);
                    for (std::size_t i = 0; i < objects.size(); ++i)
                        CHECK_FALSE(convex::intersects({mover, before}, {shapes[i], poses[i]}));
                }
                continue;
            }
            std::size_t expected = objects.size();
            double time = HUGE_VAL;
            for (std::size_t i = 0; i < objects.size(); ++i) {
                const auto own = convex::cast({mover, from}, fly, {shapes[i], poses[i]}, {}).value();
                REQUIRE(own.result != convex::CastResult::unresolved);
                if (own.result == convex::CastResult::miss || own.time >= time) continue;
                CHECK(own.steps >= 1);
                expected = i;
                time = own.time;
            }
            REQUIRE(hit.has_value() == (expected < objects.size()));
            if (!hit) continue;
            ++hits;
            CHECK(hit->object == objects[expected]);
            CHECK(hit->user == 100u + expected);
            CHECK(std::abs(hit->time - time) < 2e-7);  // either within the tolerance
            const RigidTransform then = convex::moved(from, fly, hit->time);
            if (shapes[expected].kind() != convex::Kind::mesh) {
                CHECK(hit->triangle == kNoTriangle);
                continue;
            }
            ++at_triangles;
            REQUIRE(hit->triangle < soup_of_triangles.size());
            const convex::Shape triangle = soup_of_triangles.triangle(hit->triangle);
            CHECK(convex::distance({mover, then}, {triangle, poses[expected]}).distance <= 1e-6 + 4e-8);
        }
        CHECK(hits > 250);
        CHECK(at_triangles > 60);
        CHECK(unresolved > 60);
    }

    TEST_CASE("an overlap at the start is returned with its depth, or skipped, so that the next object is hit") {
        World world;
        const convex::Shape sphere = convex::Shape::sphere(0.5).value();
        const ObjectHandle near = world.add({.bound = Obb{{0, 0, 0}, glm::mat3(1.0f), glm::vec3(1.0f)}}).value();
        const ObjectHandle far = world.add({.bound = Obb{{5, 0, 0}, glm::mat3(1.0f), glm::vec3(1.0f)}}).value();
        REQUIRE(world.update().has_value());
        const RigidTransform from{glm::dmat3(1.0), {1.25, 0, 0}};
        const convex::Motion right{{8, 0, 0}, {}, {}};
        const auto first = world.cast(sphere, from, right, {}).value();
        REQUIRE(first.has_value());
        CHECK(first->object == near);
        CHECK(first->time == 0.0);
        CHECK(first->distance == doctest::Approx(-0.25));
        CHECK(first->normal.x == doctest::Approx(-1.0));
        CHECK(first->point.x == doctest::Approx(1.0));
        const auto next = world.cast(sphere, from, right, {.ignore_initial_overlaps = true}).value();
        REQUIRE(next.has_value());
        CHECK(next->object == far);
        CHECK(next->point.x == doctest::Approx(4.0));
        CHECK(next->time == doctest::Approx((4.0 - 1.75) / 8.0));
    }

    TEST_CASE("sunk in one object, a shape slides along what is flush with it, and meets what is lower or higher") {
        const convex::Shape sphere = convex::Shape::sphere(1.0).value();
        const auto ground = [](double x, double top) {
            return ObjectDescription{.bound = Obb{{x, 0, top - 1.0}, glm::mat3(1.0f), {2, 2, 1}}};
        };
        // The ball's center is at the height 0.8. It meets an edge at the height h where its own circle does.
        for (const double height : {0.0, -0.1, 0.1, -0.19})
            for (const bool flipped : {false, true}) {
                World world;
                ObjectHandle next;
                for (const bool is_next : {flipped, !flipped})
                    if (const auto added = world.add(is_next ? ground(4.0, height) : ground(0.0, 0.0)).value(); is_next)
                        next = added;
                REQUIRE(world.update().has_value());
                const auto hit = world.cast(sphere, {glm::dmat3(1.0), {0, 0, 0.8}}, {{4, 0, 0}, {}, {}},
                                            {.ignore_initial_overlaps = true});
                REQUIRE(hit.value().has_value() == (height != 0.0));
                if (height == 0.0) continue;
                CHECK((*hit)->object == next);
                CHECK(4.0 * (*hit)->time == doctest::Approx(2.0 - std::sqrt(1.0 - (0.8 - height) * (0.8 - height))));
            }
    }

    TEST_CASE("along a floor of crates side by side, each an object, nothing is hit") {
        World world;
        for (int x = -6; x <= 6; ++x)
            for (int z = -6; z <= 6; ++z)
                REQUIRE(world.add({.bound = Obb{{x, -0.5, z}, glm::mat3(1.0f), glm::vec3(0.5f)}}).has_value());
        REQUIRE(world.update().has_value());
        RandomShapes random(83);
        for (int i = 0; i < 300; ++i) {
            const convex::Shape mover = any_shape(random, 0.6);
            RigidTransform pose{i % 2 == 0 ? random.rotation() : glm::dmat3(1.0),
                                {random.number(-2, 2), 3, random.number(-2, 2)}};
            const auto fall = world.cast(mover, pose, {{0, -4, 0}, {}, {}}, {}).value();
            REQUIRE(fall.has_value());
            CHECK(fall->normal.y < -0.9999);
            pose.translation.y -= 4.0 * fall->time;
            const glm::dvec3 way(random.number(-3, 3), 0, random.number(-3, 3));
            CHECK_FALSE(world.cast(mover, pose, {way, {}, {}}, {}).value().has_value());
        }
    }
}
