// SPDX-License-Identifier: MIT
// What meets a box, a sphere, a capsule or a shape, and what is nearest.
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <crofton/crofton.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <oracle/random_boxes.hpp>
#include <random>

#include "box_at.hpp"

using namespace crofton;
using testing::box_at;

namespace {

const double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

TEST_SUITE("world/shape_queries") {
    TEST_CASE("shapes that touch a box or miss it by an ulp give the answer of the box alone, anywhere") {
        oracle::NearMisses random(31);
        int touches = 0;
        for (int i = 0; i < 600; ++i) {
            const double far = std::exp2(random.number(0.0, 40.0)), radius = std::exp2(random.number(-5.0, 25.0));
            const auto half = static_cast<float>(i % 2 ? std::exp2(random.number(-40.0, 2.0)) : 0.0);
            const Obb box = box_at(far * random.direction(), half);
            const int k = i % 3;
            Sphere sphere{box.center, radius};
            sphere.center[k] += (i % 4 < 2 ? 1.0 : -1.0) * (double{half} + radius);
            World world;
            REQUIRE(world.add({.bound = box}).has_value());
            for (int update = 0; update < (i % 5 ? 1 : 4); ++update) REQUIRE(world.update().has_value());
            for (int step = 0; step < 3; ++step) sphere.center[k] = std::nextafter(sphere.center[k], -kInfinity);
            for (int step = 0; step < 6; ++step) {
                const bool meets = collide::intersects(box, sphere);
                Vector<ObjectRef> found;
                world.overlap(sphere, found);
                CHECK(found.size() == (meets ? 1 : 0));
                world.overlap(collide::Capsule{sphere.center, sphere.center, radius}, found);
                CHECK(found.size() == (meets ? 1 : 0));
                touches += meets;
                sphere.center[k] = std::nextafter(sphere.center[k], kInfinity);
            }
        }
        CHECK(touches > 600);
    }

    TEST_CASE("a corner that axes at the limit of their deviation push out is met") {
        // Axes a little long, all angles a little narrow: so the diagonal is long. Turned, so that it lies along x.
        const double e = 0.9 * kMaxAxisDeviation / 2.0;
        const glm::dmat3 narrow = (1.0 + e) * glm::dmat3(1.0, e, e, e, 1.0, e, e, e, 1.0);
        const glm::dvec3 x = glm::normalize(glm::dvec3(1.0)), y = glm::normalize(glm::dvec3(1.0, -1.0, 0.0));
        const glm::dmat3 turn = glm::transpose(glm::dmat3(x, y, glm::cross(x, y)));
        const Obb box{{}, glm::mat3(turn * narrow), glm::vec3(1.0f)};
        World world;
        REQUIRE(world.add({.bound = box}).has_value());
        REQUIRE(world.update().has_value());
        Obb probe = box_at({}, 0.0f);
        probe.center = corners(box)[7];
        probe.center.x -= 1e-6;
        REQUIRE(collide::intersects(box, probe));
        Vector<ObjectRef> found;
        world.overlap(probe, found);
        CHECK(found.size() == 1);
    }

    TEST_CASE("a distance without end reaches from one side of all coordinates to the other") {
        World world;
        REQUIRE(world.add({.bound = box_at({9e29, 0.0, 0.0})}).has_value());
        REQUIRE(world.update().has_value());
        const auto nearest = world.closest(Sphere{{-9e29, 0.0, 0.0}, 1.0}, kInfinity);
        REQUIRE(nearest.has_value());
        CHECK(nearest->distance == doctest::Approx(1.8e30));
        CHECK(!world.closest(Sphere{{-9e29, 0.0, 0.0}, 1.0}, 1e30));
    }

    TEST_CASE("spheres and capsules beyond the largest coordinate meet nothing, and nothing is near them") {
        World world;
        REQUIRE(world.add({.bound = Obb{}}).has_value());
        REQUIRE(world.add({.bound = Sphere{{3, 0, 0}, 1.0}}).has_value());
        REQUIRE(world.update().has_value());
        Vector<ObjectRef> found;
        for (const double far : {1.1e30, 1e155, 1e200, 1e308}) {
            CAPTURE(far);
            CHECK(!world.closest(Sphere{{far, 0, 0}, 1.0}, INFINITY));
            CHECK(!world.closest(collide::Capsule{{}, {0, far, 0}, 1.0}, INFINITY));
            world.overlap(Sphere{{}, far}, found);
            CHECK(found.empty());
            world.overlap(collide::Capsule{{-far, 0, 0}, {far, 0, 0}, 1.0}, found);
            CHECK(found.empty());
        }
    }

    TEST_CASE("spheres smaller than any float meet where they touch") {
        for (const double radius : {1e-46, 1e-45, 2e-45, 1e-40, 1e-38}) {
            CAPTURE(radius);
            World world;
            REQUIRE(world.add({.bound = Sphere{{}, radius}}).has_value());
            REQUIRE(world.add({.bound = Sphere{{2.0 * radius, 0.0, 0.0}, radius}}).has_value());
            REQUIRE(world.update().has_value());
            CHECK(world.pairs().size() == 1);
        }
    }

    TEST_CASE("a box whose axes are not quite orthonormal is met at its corners") {
        const auto speck = convex::Shape::sphere(1e-14).value();
        std::mt19937_64 rng(8);
        std::uniform_real_distribution<float> number(-1.0f, 1.0f), size(1.0f, 2.0f);
        for (int round = 0; round < 100; ++round) {
            CAPTURE(round);
            glm::mat3 axes =
                glm::mat3_cast(glm::normalize(glm::quat(1.5f + number(rng), number(rng), number(rng), number(rng))));
            axes[0] *= 1.0f + 2e-5f * number(rng);
            axes[1] += 3e-5f * axes[0];
            const Obb box{{0.0, 0.0, 0.0}, axes, {size(rng), size(rng), size(rng)}};
            World world;
            REQUIRE(world.add({.bound = box}).has_value());
            REQUIRE(world.update().has_value());
            for (unsigned corner = 0; corner < 8; ++corner) {
                RigidTransform at;
                for (int k = 0; k < 3; ++k)
                    at.translation += (corner >> k & 1 ? 1.0 : -1.0) * static_cast<double>(box.half_extents[k]) *
                                      glm::dvec3(box.axes[k]);
                Vector<ObjectRef> found;
                world.overlap(speck, at, found);
                CHECK(found.size() == 1);
            }
        }
    }
}
