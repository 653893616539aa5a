// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include "surfaces.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

TEST_SUITE("convex/surface_cast") {
    TEST_CASE("the first touch with a surface is the first of its triangles' one by one, under any motion of both") {
        RandomBodies random(1);
        int hits = 0, misses = 0;
        for (int round = 0; round < 150; ++round) {
            const Surface s = soup(random, 80, 3.0, 0.4);
            const Body body = s.body(), b = any_body(random, 0.4);
            const double offset = round % 3 == 0 ? 1e6 : 0.0;
            const RigidTransform pose{random.rotation(), offset * random.direction()};
            const RigidTransform pose_b{random.rotation(), pose.translation + 5.0 * random.direction()};
            const Motion still, turning{random.direction(), 2.0 * random.direction(), random.direction()};
            const Motion flying{2.0 * (pose.translation - pose_b.translation) + 2.0 * random.direction(),
                                random.index(2) * random.number(0, 9) * random.direction(), 0.2 * random.direction()};
            const Motion& motion = round % 2 == 0 ? still : turning;
            const CastOptions options{.tolerance = 1e-6, .max_steps = 5000};
            Impact first;
            first.time = 1.0;
            for (std::size_t t = 0; t < s.size(); ++t) {
                const Impact i = cast({s.triangle(t), pose}, motion, {b, pose_b}, flying, options).value();
                if (i.result != CastResult::miss && i.time < first.time) first = i;
            }
            const Impact i = cast({body, pose}, motion, {b, pose_b}, flying, options).value();
            const Impact back = cast({b, pose_b}, flying, {body, pose}, motion, options).value();
            CHECK(i.result == first.result);
            CHECK(std::abs(i.time - first.time) <= 2e-6);
            CHECK(back.result == first.result);
            CHECK(std::abs(back.time - first.time) <= 2e-6);
            CHECK(back.part_b == i.part_a);
            (first.result == CastResult::hit ? hits : misses) += 1;
            if (i.result != CastResult::hit) continue;
            // A flight that ends just behind the touch hits as well.
            const CastOptions shorter{.duration = i.time * 1.001 + 1e-4, .tolerance = 1e-6, .max_steps = 5000};
            CHECK(cast({body, pose}, motion, {b, pose_b}, flying, shorter).value().result == CastResult::hit);
            const RigidTransform then = moved(pose, motion, i.time), b_then = moved(pose_b, flying, i.time);
            CHECK(distance({s.triangle(i.part_a.triangle), then}, {b, b_then}).distance <= 1e-6 + 1e-9 * offset);
        }
        CHECK(hits > 40);
        CHECK(misses > 20);
    }

    TEST_CASE("no floor is too thin, no way too long: a grain at 1e5 a second through 20,000 triangles") {
        RandomBodies random(2);
        const Surface s = ground(random, 100, 0.2, [](double x, double z) { return 0.1 * std::sin(3 * x + z); });
        const Body floor = s.body(), grain = Body::box({1e-3f, 1e-3f, 1e-3f}).value();
        for (int i = 0; i < 100; ++i) {
            const glm::dvec3 target(random.number(-8, 8), 0.0, random.number(-8, 8));
            glm::dvec3 way = 1e5 * random.direction();
            if (std::abs(way.y) < 3e4) continue;
            const RigidTransform from = at(target - 0.4 * way);
            const Impact hit =
                cast({grain, from}, {way, 300.0 * random.direction(), {}}, {floor, at({})}, {}, {}).value();
            CHECK(hit.result == CastResult::hit);
            CHECK(hit.time == doctest::Approx(0.4).epsilon(1e-4));
        }
        // Along the floor just above it: many triangles near, and none hit.
        const Impact along = cast({grain, at({-9.9, 0.2, 0.3})}, {{19.0, 0, 0}, {}, {}}, {floor, at({})}, {}).value();
        CHECK(along.result == CastResult::miss);
    }

    TEST_CASE("front sides alone: from behind a body passes, from the front it hits") {
        RandomBodies random(3);
        const Surface s = ground(random, 16, 0.5, [](double, double) { return 0.0; });
        const Body front = s.body(Sides::front), sphere = Body::sphere(0.25f).value();
        const Motion up{{0, 4, 0}, {}, {}}, down{{0, -4, 0}, {}, {}};
        CHECK(cast({sphere, at({0.1, -2, 0})}, up, {front, at({})}, {}).value().result == CastResult::miss);
        CHECK(cast({sphere, at({0.1, -2, 0})}, up, {s.body(), at({})}, {}).value().result == CastResult::hit);
        const Impact hit = cast({sphere, at({0.1, 2, 0})}, down, {front, at({})}, {}).value();
        CHECK(hit.result == CastResult::hit);
        CHECK(hit.time == doctest::Approx(1.75 / 4).epsilon(1e-5));
        CHECK(hit.normal.y == doctest::Approx(-1.0));
    }

    TEST_CASE("bad motions are named errors also for surfaces") {
        RandomBodies random(4);
        const Surface s = soup(random, 3, 1.0, 1.0);
        const Body body = s.body(), sphere = Body::sphere(1.0f).value();
        const auto bad = cast({body, at({})}, {{NAN, 0, 0}, {}, {}}, {sphere, at({})}, {});
        REQUIRE_FALSE(bad.has_value());
        CHECK(bad.error().code == ErrorCode::non_finite);
        CHECK(cast({body, at({})}, {}, {sphere, at({9, 0, 0})}, {}, {.duration = 0.0}).value().result ==
              CastResult::miss);
    }
}
