// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <error_of.hpp>

#include "surfaces.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

bool brute_meets(const Surface& s, const RigidTransform& pose, const ShapeAtPose& b) {
    for (std::size_t i = 0; i < s.size(); ++i)
        if (intersects({s.triangle(i), pose}, b)) return true;
    return false;
}

}  // namespace

TEST_SUITE("convex/surface") {
    TEST_CASE("a tree without triangles is refused, and what is not convex is not rounded") {
        const mesh::MeshTree none;
        REQUIRE_FALSE(Shape::mesh(none).has_value());
        CHECK(error_of(Shape::mesh(none)).code == ErrorCode::empty);
        RandomShapes random(1);
        const Surface s = soup(random, 3, 1.0, 1.0);
        REQUIRE_FALSE(Shape::rounded(s.shape(), 1.0f).has_value());
        CHECK(error_of(Shape::rounded(s.shape(), 1.0f)).code == ErrorCode::unsupported);
    }

    TEST_CASE("yes or no is that of the triangles one by one, at every gap and offset, for every kind of shape") {
        RandomShapes random(2);
        int meeting = 0, apart = 0;
        for (const double offset : {0.0, 1e3, 1e7})
            for (int round = 0; round < 8; ++round) {
                const Surface s = soup(random, 300, 6.0, 0.6);
                const Shape shape = s.shape();
                const RigidTransform pose{random.rotation(), offset * random.direction()};
                for (int i = 0; i < 40; ++i) {
                    const Shape b = any_shape(random);
                    const double gap = (i % 2 == 0 ? 1.0 : -1.0) * std::pow(10.0, -random.number(0, 12));
                    const RigidTransform pose_b = next_to(random, s, pose, b, gap);
                    const bool truth = brute_meets(s, pose, {b, pose_b});
                    CHECK(intersects({shape, pose}, {b, pose_b}) == truth);
                    CHECK(intersects({b, pose_b}, {shape, pose}) == truth);
                    (truth ? meeting : apart) += 1;
                }
            }
        CHECK(meeting > 200);
        CHECK(apart > 100);
    }

    TEST_CASE("balls and capsules have contacts iff the margin is not below the distance of the nearest triangle") {
        RandomShapes random(47);
        for (int i = 0; i < 120; ++i) {
            CAPTURE(i);
            const double scale = std::pow(10.0, random.number(-3, 3)), offset = i % 3 == 0 ? 0.0 : 1e3 * scale;
            const Surface s = soup(random, 300, 10.0 * scale, 2.0 * scale);
            const RigidTransform pose{random.rotation(), offset * random.direction()};
            for (int k = 0; k < 8; ++k) {
                const double radius = scale * std::pow(10.0, random.number(-4, 0)),
                             length = scale * std::pow(10.0, random.number(-3, 1));
                const Shape shape =
                    k % 2 == 0 ? Shape::sphere(static_cast<float>(radius)).value()
                               : Shape::capsule(static_cast<float>(length), static_cast<float>(radius)).value();
                const RigidTransform place{random.rotation(),
                                           pose.translation + random.number(3, 30) * scale * random.direction()};
                double least = HUGE_VAL;
                for (std::size_t t = 0; t < s.size(); ++t)
                    least = std::min(least, distance({s.triangle(t), pose}, {shape, place}).distance);
                if (least < 1e-3 * scale) continue;
                Manifolds found;
                for (const double part : {1.0 - 1e-9, 1.0 + 1e-9}) {
                    contact_manifolds({s.shape(), pose}, {shape, place}, {.margin = part * least}, found);
                    CHECK(found.all().empty() == (part < 1.0));
                }
            }
        }
    }

    TEST_CASE("triangles so far from the surface's origin that a step of float is an eighth are met where they are") {
        RandomShapes random(7);
        int meeting = 0;
        for (int round = 0; round < 20; ++round) {
            Surface s = soup(random, 20, 3.0, 0.6);
            for (glm::vec3& p : s.mesh.positions) p[round % 3] += 0x1.01p20f;
            s.build();
            const Shape shape = s.shape(), box = Shape::box({0.3f, 0.4f, 0.5f}).value();
            const RigidTransform pose{glm::dmat3(1.0), glm::dvec3(0.0)};
            for (int i = 0; i < 40; ++i) {
                RigidTransform pose_b = next_to(random, s, pose, box, -1e-3);
                pose_b.rotation = glm::dmat3(1.0);  // and beside it, or in it
                const bool truth = brute_meets(s, pose, {box, pose_b});
                CHECK(intersects({shape, pose}, {box, pose_b}) == truth);
                meeting += truth;
                pose_b = next_to(random, s, pose, box, -1e-3);
                CHECK(intersects({shape, pose}, {box, pose_b}));
            }
        }
        CHECK(meeting > 50);
    }

    TEST_CASE("distances are the least of the triangles' one by one, with points and bounds") {
        RandomShapes random(3);
        int apart = 0;
        for (int round = 0; round < 10; ++round) {
            const Surface s = soup(random, 200, 4.0, 0.5);
            const Shape shape = s.shape();
            const RigidTransform pose{random.rotation(), random.number(0, 1e4) * random.direction()};
            for (int i = 0; i < 20; ++i) {
                const Shape b = any_shape(random, 0.5);
                const RigidTransform pose_b{random.rotation(), pose.translation + 6.0 * random.direction()};
                Distance least;
                least.distance = HUGE_VAL;
                for (std::size_t t = 0; t < s.size(); ++t) {
                    const Shape triangle = s.triangle(t);
                    const Distance d = distance({triangle, pose}, {b, pose_b});
                    if (d.distance < least.distance) least = d;
                }
                const Distance d = distance({shape, pose}, {b, pose_b});
                const double size = 1e-9 * (shape.core_radius() + b.core_radius() + 12.0);
                CHECK(std::abs(d.distance - least.distance) <= 2.0 * size);
                CHECK(d.lower <= least.upper);
                CHECK(d.distance <= d.upper);
                CHECK(d.lower <= d.distance);
                if (d.distance == 0.0) continue;
                ++apart;
                CHECK(glm::distance(d.on_a, d.on_b) == doctest::Approx(d.distance).epsilon(1e-6));
                const Shape nearest = s.triangle(d.part_a.triangle);
                CHECK(closest_point({nearest, pose}, d.on_a).distance <= size);
                const Distance back = distance({b, pose_b}, {shape, pose});
                CHECK(back.distance == doctest::Approx(d.distance));
                CHECK(back.part_b == d.part_a);
            }
        }
        CHECK(apart > 80);
    }

    TEST_CASE(
        "the tree leaves out what is far: a small box is asked of few of 20,000 triangles, and of all it may meet") {
        RandomShapes random(4);
        const Surface s = ground(random, 100, 1.0, [](double x, double z) { return 0.3 * std::sin(x) * std::cos(z); });
        const Shape shape = s.shape(), box = Shape::box({0.5f, 0.5f, 0.5f}).value();
        Vector<Part> parts;
        std::size_t most = 0;
        for (int i = 0; i < 200; ++i) {
            const RigidTransform pose{random.rotation(), {random.number(-40, 40), 0.3, random.number(-40, 40)}};
            parts_near({shape, at({})}, {box, pose}, 0.1, parts);
            most = std::max(most, parts.size());
            std::vector<bool> told(s.size(), false);
            for (const Part& part : parts) told[part.id.triangle] = true;
            for (std::size_t t = 0; t < s.size(); ++t)
                if (!told[t] && distance({s.triangle(t), at({})}, {box, pose}).distance <= 0.1) CHECK(told[t]);
            if (i % 20 != 0) continue;
            parts_near({shape, at({})}, {box, at({0, 200, 0})}, 0.1, parts);
            CHECK(parts.empty());
        }
        CHECK(most < 60);
    }

    TEST_CASE("a half-space and a surface, and a point next to one") {
        RandomShapes random(5);
        const Surface s = soup(random, 50, 2.0, 0.5);
        const Shape shape = s.shape(), floor = Shape::half_space({{0, -1, 0}, -9.0}).value();
        CHECK_FALSE(intersects({shape, at({})}, {floor, at({})}));
        double lowest = HUGE_VAL;
        for (const glm::vec3& p : s.mesh.positions) lowest = std::min(lowest, double(p.y));
        CHECK(distance({shape, at({})}, {floor, at({})}).distance == doctest::Approx(lowest + 9.0));
        CHECK(intersects({floor, at({})}, {shape, at({0, -9.0 - lowest, 0})}));
        const Surface plain = ground(random, 4, 1.0, [](double, double) { return 1.0; });
        const Distance d = closest_point({plain.shape(), at({})}, {0.1, 3.0, 0.2});
        CHECK(d.distance == doctest::Approx(2.0));
        CHECK(d.on_b.y == doctest::Approx(1.0));
    }

    TEST_CASE("two surfaces and their triangles: meeting and distance") {
        RandomShapes random(6);
        for (int i = 0; i < 12; ++i) {
            const Surface a = soup(random, 40, 1.0, 0.3), b = soup(random, 30, 1.0, 0.3);
            const RigidTransform pose_a{random.rotation(), {}}, pose_b{random.rotation(), 2.5 * random.direction()};
            double least = HUGE_VAL;
            for (std::size_t t = 0; t < b.size(); ++t)
                for (std::size_t u = 0; u < a.size(); ++u)
                    least = std::min(least, distance({a.triangle(u), pose_a}, {b.triangle(t), pose_b}).distance);
            CHECK(intersects({a.shape(), pose_a}, {b.shape(), pose_b}) == (least == 0.0));
            const Distance d = distance({a.shape(), pose_a}, {b.shape(), pose_b});
            CHECK(d.distance == doctest::Approx(least));
            if (least > 0.0)
                CHECK(distance({a.triangle(d.part_a.triangle), pose_a}, {b.triangle(d.part_b.triangle), pose_b})
                          .distance == doctest::Approx(least));
        }
    }
}
