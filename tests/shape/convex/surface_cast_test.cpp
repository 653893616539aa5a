// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <ctime>

#include "flat_floors.hpp"
#include "surfaces.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

TEST_SUITE("convex/surface_cast") {
    TEST_CASE("the first touch with a surface is the first of its triangles' one by one, under any motion of both") {
        RandomShapes random(1);
        int hits = 0, misses = 0;
        for (int round = 0; round < 150; ++round) {
            const Surface s = soup(random, 80, 3.0, 0.4);
            const Shape shape = s.shape(), b = any_shape(random, 0.4);
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
            const Impact i = cast({shape, pose}, motion, {b, pose_b}, flying, options).value();
            const Impact back = cast({b, pose_b}, flying, {shape, pose}, motion, options).value();
            CHECK(i.result == first.result);
            CHECK(std::abs(i.time - first.time) <= 2e-6);
            CHECK(back.result == first.result);
            CHECK(std::abs(back.time - first.time) <= 2e-6);
            CHECK(back.part_b == i.part_a);
            (first.result == CastResult::hit ? hits : misses) += 1;
            if (i.result != CastResult::hit) continue;
            // A flight that ends just behind the touch hits as well.
            const CastOptions shorter{.duration = i.time * 1.001 + 1e-4, .tolerance = 1e-6, .max_steps = 5000};
            CHECK(cast({shape, pose}, motion, {b, pose_b}, flying, shorter).value().result == CastResult::hit);
            const RigidTransform then = moved(pose, motion, i.time), b_then = moved(pose_b, flying, i.time);
            CHECK(distance({s.triangle(i.part_a.triangle), then}, {b, b_then}).distance <= 1e-6 + 1e-9 * offset);
        }
        CHECK(hits > 40);
        CHECK(misses > 20);
    }

    TEST_CASE(
        "two surfaces that turn first touch where the first two of their triangles do, from contact and from afar") {
        RandomShapes random(31);
        int hits = 0, misses = 0, at_start = 0;
        for (int round = 0; round < 60; ++round) {
            const Surface s = soup(random, 14, 1.5, 0.5), other = soup(random, 12, 1.5, 0.5);
            const RigidTransform pose{random.rotation(), 10.0 * random.direction()};
            const RigidTransform pose_b{random.rotation(),
                                        pose.translation + random.number(0.0, 5.0) * random.direction()};
            // Pivots far off, as a triangle of a mesh that turns has them.
            const glm::dvec3 way = random.number(0.0, 3.0) * (pose.translation - pose_b.translation);
            const glm::dvec3 spin_a = random.index(2) * random.number(0.0, 4.0) * random.direction(),
                             spin_b = random.index(3) * random.number(0.0, 4.0) * random.direction(),
                             pivot_a = 3.0 * random.direction(), pivot_b = 3.0 * random.direction();
            const Motion motion_a{{}, spin_a, pivot_a}, motion_b{way, spin_b, pivot_b};
            const CastOptions options{.tolerance = 1e-6, .max_steps = 5000};
            Impact first;
            first.time = 1.0;
            for (std::size_t t = 0; t < s.size(); ++t)
                for (std::size_t u = 0; u < other.size(); ++u) {
                    const Impact i =
                        cast({s.triangle(t), pose}, motion_a, {other.triangle(u), pose_b}, motion_b, options).value();
                    if (i.result != CastResult::miss && i.time < first.time) first = i;
                }
            const Impact i = cast({s.shape(), pose}, motion_a, {other.shape(), pose_b}, motion_b, options).value();
            const Impact back = cast({other.shape(), pose_b}, motion_b, {s.shape(), pose}, motion_a, options).value();
            CHECK(i.result == first.result);
            CHECK(back.result == first.result);
            CHECK(std::abs(i.time - first.time) <= 2e-6);
            CHECK(std::abs(back.time - first.time) <= 2e-6);
            (first.result == CastResult::hit ? hits : misses) += 1;
            at_start += first.result == CastResult::hit && first.time == 0.0 ? 1 : 0;
            if (first.result != CastResult::hit) continue;
            const RigidTransform then = moved(pose, motion_a, i.time), b_then = moved(pose_b, motion_b, i.time);
            CHECK(
                distance({s.triangle(i.part_a.triangle), then}, {other.triangle(i.part_b.triangle), b_then}).distance <=
                1e-6 + 1e-9);
        }
        CHECK(hits > 20);
        CHECK(misses > 5);
        CHECK(at_start > 5);
    }

    TEST_CASE("equal surfaces at one pose touch at once, whether they fly or turn, at about the same cost") {
        RandomShapes random(32);
        const Surface s = ground(random, 30, 0.1, [](double x, double z) { return std::sin(3 * x + z); });
        const Shape shape = s.shape();
        const auto seconds = [&](const Motion& motion) {
            const std::clock_t start = std::clock();
            const Impact i = cast({shape, at({})}, {}, {shape, at({})}, motion, {}).value();
            CHECK(i.result == CastResult::hit);
            CHECK(i.time == 0.0);
            return double(std::clock() - start) / CLOCKS_PER_SEC;
        };
        const double flies = seconds({{1, 0, 0}, {}, {}});
        // Every triangle was asked against every other: 60 times as long.
        CHECK(seconds({{}, {0, 1, 0}, {}}) <= 10.0 * flies + 0.1);
        CHECK(seconds({{1, 0, 0}, {0, 0, 1}, {5, 0, 0}}) <= 10.0 * flies + 0.1);
    }

    TEST_CASE("no floor is too thin, no way too long: a grain at 1e5 a second through 20,000 triangles") {
        RandomShapes random(2);
        const Surface s = ground(random, 100, 0.2, [](double x, double z) { return 0.1 * std::sin(3 * x + z); });
        const Shape floor = s.shape(), grain = Shape::box({1e-3f, 1e-3f, 1e-3f}).value();
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

    TEST_CASE("front sides alone: from behind a shape passes, from the front it hits") {
        RandomShapes random(3);
        const Surface s = ground(random, 16, 0.5, [](double, double) { return 0.0; });
        const Shape front = s.shape(Sides::front), sphere = Shape::sphere(0.25f).value();
        const Motion up{{0, 4, 0}, {}, {}}, down{{0, -4, 0}, {}, {}};
        CHECK(cast({sphere, at({0.1, -2, 0})}, up, {front, at({})}, {}).value().result == CastResult::miss);
        CHECK(cast({sphere, at({0.1, -2, 0})}, up, {s.shape(), at({})}, {}).value().result == CastResult::hit);
        const Impact hit = cast({sphere, at({0.1, 2, 0})}, down, {front, at({})}, {}).value();
        CHECK(hit.result == CastResult::hit);
        CHECK(hit.time == doctest::Approx(1.75 / 4).epsilon(1e-5));
        CHECK(hit.normal.y == doctest::Approx(-1.0));
    }

    TEST_CASE("what passes over an edge nearer than the tolerance misses, and what flies a little lower hits") {
        RandomShapes random(36);
        Surface s;  // a blade whose upper edge lies along x
        s.mesh.positions = {{-3, 0, 0}, {3, 0, 0}, {3, -2, 0}, {-3, -2, 0}};
        s.mesh.indices = {0, 1, 2, 0, 2, 3};
        s.build();
        const Shape blade = s.shape();
        struct Flier {
            Shape shape;
            glm::dmat3 lying;  // its lower side is level
            double low;        // below its origin
        };
        const Flier fliers[] = {
            {Shape::sphere(0.5f).value(), glm::dmat3(1.0), 0.5},
            {Shape::capsule(0.5f, 0.25f).value(), glm::dmat3({0, -1, 0}, {1, 0, 0}, {0, 0, 1}), 0.25},
            {Shape::box({0.5f, 0.25f, 0.375f}).value(), glm::dmat3(1.0), 0.25},
            {Shape::rounded(Shape::box({0.5f, 0.25f, 0.375f}).value(), 0.125f).value(), glm::dmat3(1.0), 0.375}};
        for (int i = 0; i < 4000; ++i) {
            const Flier& flier = fliers[i % 4];
            const double tolerance = std::pow(10.0, random.number(-5, -2)),
                         above = tolerance * (i % 8 < 4 ? random.number(0.05, 0.95) : -random.number(0.05, 2.0));
            const RigidTransform frame{random.rotation(), random.number(0, 30) * random.direction()};
            const glm::dvec3 from(random.number(-1, 1), flier.low + above, -2.0);
            const RigidTransform pose{frame.rotation * around_y(random.number(0, 6)) * flier.lying,
                                      frame.translation + frame.rotation * from};
            const Motion motion{frame.rotation * glm::dvec3(random.number(-0.5, 0.5), 0.0, 4.0), {}, {}};
            const CastOptions options{.tolerance = tolerance};
            const CastResult expected = above > 0.0 ? CastResult::miss : CastResult::hit;
            CAPTURE(i);
            CHECK(cast({blade, frame}, {}, {flier.shape, pose}, motion, options)->result == expected);
            CHECK(cast({flier.shape, pose}, motion, {blade, frame}, {}, options)->result == expected);
        }
    }

    TEST_CASE("bad motions are named errors also for surfaces") {
        RandomShapes random(4);
        const Surface s = soup(random, 3, 1.0, 1.0);
        const Shape shape = s.shape(), sphere = Shape::sphere(1.0f).value();
        const auto bad = cast({shape, at({})}, {{NAN, 0, 0}, {}, {}}, {sphere, at({})}, {});
        REQUIRE_FALSE(bad.has_value());
        CHECK(bad.error().code == ErrorCode::non_finite);
        CHECK(cast({shape, at({})}, {}, {sphere, at({9, 0, 0})}, {}, {.duration = 0.0}).value().result ==
              CastResult::miss);
    }
}
