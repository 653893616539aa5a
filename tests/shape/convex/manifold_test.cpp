// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <vector>

#include "contact_ids.hpp"
#include "random_shapes.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

TEST_SUITE("convex/manifold") {
    TEST_CASE("shapes that are NaN or apart have no points, those within the margin have gaps") {
        const Shape box = Shape::box({1, 1, 1}).value();
        const RigidTransform low = at({}), high = at({0, 2.01, 0}), bad = at({NAN, 0, 0});
        CHECK(contact_manifold({box, low}, {box, bad}).count == 0);
        CHECK(contact_manifold({box, low}, {box, high}).count == 0);
        const Manifold m = contact_manifold({box, low}, {box, high}, {.margin = 0.02});
        CHECK(m.count == 4);
        CHECK(m.depth == doctest::Approx(-0.01));
        CHECK(m.normal.y == doctest::Approx(1.0));
        for (int i = 0; i < m.count; ++i) CHECK(m.points[i].depth == doctest::Approx(-0.01));
    }

    TEST_CASE("manifolds known by hand: face on face, turned by 45 degrees, a corner on a face, crossed edges") {
        const Shape box = Shape::box({1, 1, 1}).value(), big = Shape::box({5, 1, 5}).value();
        const RigidTransform low = at({}), high = at({0.5, 1.9, 0});
        Manifold m = contact_manifold({box, low}, {box, high});
        CHECK(m.count == 4);
        CHECK(ids(m).size() == 4);
        for (int i = 0; i < m.count; ++i) {
            CHECK(m.points[i].depth == doctest::Approx(0.1));
            CHECK(m.points[i].position.y == doctest::Approx(0.95));
            CHECK(m.points[i].position.x >= -0.5 - 1e-12);
        }
        RigidTransform turned = high;
        turned.translation.x = 0.0;
        turned.rotation = glm::mat3_cast(glm::angleAxis(0.785398, glm::dvec3(0, 1, 0)));
        m = contact_manifold({box, low}, {box, turned}, {.max_points = 8});
        CHECK(m.count == 8);
        CHECK(ids(m).size() == 8);
        CHECK(contact_manifold({box, low}, {box, turned}).count == 4);
        // A corner down.
        RigidTransform corner = at({0, 1.0 + std::sqrt(3.0) - 0.01, 0});
        corner.rotation =
            glm::mat3_cast(glm::angleAxis(std::acos(1.0 / std::sqrt(3.0)), glm::normalize(glm::dvec3(-1, 0, 1))));
        m = contact_manifold({big, low}, {box, corner});
        CHECK(m.count == 1);
        CHECK(m.depth == doctest::Approx(0.01).epsilon(1e-3));
        CHECK(m.points[0].on_a == Feature{FeatureKind::face, 3});
        CHECK(m.points[0].on_b.kind == FeatureKind::vertex);
        // Two long bars crossed on their edges.
        const Shape bar = Shape::box({5, 0.5f, 0.5f}).value();
        RigidTransform first = at({}), second = at({0, std::sqrt(2.0) - 0.01, 0});
        const glm::dmat3 tilt = glm::mat3_cast(glm::angleAxis(0.78539816339744831, glm::dvec3(1, 0, 0)));
        first.rotation = tilt;
        second.rotation = glm::mat3_cast(glm::angleAxis(1.57079632679489662, glm::dvec3(0, 1, 0))) * tilt;
        m = contact_manifold({bar, first}, {bar, second});
        CHECK(m.count == 1);
        CHECK(m.points[0].on_a.kind == FeatureKind::edge);
        CHECK(m.points[0].on_b.kind == FeatureKind::edge);
        CHECK(m.normal.y == doctest::Approx(1.0));
        CHECK(m.depth == doctest::Approx(0.01));
    }

    TEST_CASE("among equally good points the first are kept, so that a shape at rest keeps its points") {
        // An octagon on a floor: two squares of its corners span the same area.
        std::vector<glm::vec3> corners;
        for (const glm::vec2 p : {glm::vec2(2, 1), glm::vec2(1, 2), glm::vec2(-1, 2), glm::vec2(-2, 1),
                                  glm::vec2(-2, -1), glm::vec2(-1, -2), glm::vec2(1, -2), glm::vec2(2, -1)})
            for (const float y : {-1.0f, 1.0f}) corners.emplace_back(p.x, y, p.y);
        const Hull hull = Hull::build(corners).value();
        const Shape octagon = Shape::hull(hull), floor = Shape::box({9, 1, 9}).value();
        const RigidTransform low = at({}), high = at({0, 1.75, 0});
        const Manifold all = contact_manifold({floor, low}, {octagon, high}, {.max_points = 8});
        REQUIRE(all.count == 8);
        const Manifold four = contact_manifold({floor, low}, {octagon, high});
        REQUIRE(four.count == 4);
        for (int i = 0; i < 4; ++i) CHECK(four.points[i].position == all.points[2 * i].position);
    }

    TEST_CASE("round shapes: a capsule and a cylinder lying, standing, on a box and on a half-space") {
        const Shape floor = Shape::half_space({{0, -1, 0}, 0}).value(), slab = Shape::box({9, 1, 9}).value();
        const Shape capsule = Shape::capsule(1, 0.5f).value(), cylinder = Shape::cylinder(1, 0.5f).value();
        const RigidTransform ground = at({}), below = at({0, -1, 0});
        RigidTransform lying = at({0, 0.49, 0}), standing = at({0, 0.99, 0});
        lying.rotation = glm::mat3_cast(glm::angleAxis(1.57079632679489662, glm::dvec3(0, 0, 1)));
        for (const ShapeAtPose& bottom : {ShapeAtPose{floor, ground}, ShapeAtPose{slab, below}}) {
            Manifold m = contact_manifold(bottom, {capsule, lying});
            CHECK(m.count == 2);
            CHECK(m.depth == doctest::Approx(0.01));
            CHECK(m.normal.y == doctest::Approx(1.0));
            m = contact_manifold(bottom, {cylinder, lying});
            CHECK(m.count == 2);
            CHECK(m.depth == doctest::Approx(0.01));
            m = contact_manifold(bottom, {cylinder, standing});
            CHECK(m.count == 4);
            CHECK(m.depth == doctest::Approx(0.01));
            CHECK(contact_manifold(bottom, {cylinder, standing}, {.max_points = 8}).count == 8);
            m = contact_manifold({cylinder, standing}, bottom);
            CHECK(m.normal.y == doctest::Approx(-1.0));
            CHECK(m.count == 4);
        }
    }

    TEST_CASE("the deepest point is as deep as the penetration, shapes that meet have a point, others none") {
        RandomShapes random(1);
        int points = 0;
        for (int i = 0; i < 2000; ++i) {
            const Shape a = random.polytope(32),
                        b = i % 7 == 0 ? Shape::cylinder(0.5f, 0.5f).value() : random.polytope(32);
            const CasePair where =
                nearly_touching(random, a, b, -std::pow(10.0, random.number(-8, -0.5)) * (i % 3 - 0.5), 0.0);
            const ShapeAtPose pa{a, where.pose_a}, pb{b, where.pose_b};
            const Manifold m = contact_manifold(pa, pb, {.max_points = 8});
            CHECK((m.count > 0) == intersects(pa, pb));
            if (m.count == 0) continue;
            points += m.count;
            const Penetration p = penetration(pa, pb);
            CHECK(m.depth == doctest::Approx(p.depth).epsilon(1e-6).scale(1e-2));
            double deepest = -1.0;
            for (int k = 0; k < m.count; ++k) {
                CHECK(m.points[k].depth >= 0.0);
                CHECK(m.points[k].depth <= m.depth);
                deepest = std::max(deepest, m.points[k].depth);
                // Midway between the surfaces: within half the depth of either shape.
                CHECK(closest_point(pa, m.points[k].position).distance <= 0.5 * m.points[k].depth + 1e-4);
                CHECK(closest_point(pb, m.points[k].position).distance <= 0.5 * m.points[k].depth + 1e-4);
            }
            CHECK(deepest == m.depth);
        }
        CHECK(points > 2000);
    }

    TEST_CASE("no more points than are wanted, none of them twice, the deepest among them") {
        RandomShapes random(4);
        const Shape box = Shape::box({1, 1, 1}).value();
        const RigidTransform low = at({});
        for (int i = 0; i < 200; ++i) {
            RigidTransform top = at({random.number(-0.1, 0.1), 1.9, random.number(-0.1, 0.1)});
            top.rotation = glm::mat3_cast(glm::angleAxis(random.number(0.0, 1.6), glm::dvec3(0, 1, 0)) *
                                          glm::angleAxis(random.number(0.0, 0.01), random.direction()));
            const Manifold full = contact_manifold({box, low}, {box, top}, {.max_points = 8});
            for (int most = 1; most <= 8; ++most) {
                const Manifold m = contact_manifold({box, low}, {box, top}, {.max_points = most});
                CHECK(m.count >= 1);
                CHECK(m.count <= most);
                CHECK(ids(m).size() == static_cast<std::size_t>(m.count));
                CHECK(m.depth == doctest::Approx(full.depth).epsilon(1e-7));
            }
        }
    }

    TEST_CASE("a box next to a half-space has points iff they meet, however near") {
        RandomShapes random(17);
        int meeting = 0;
        for (int i = 0; i < 2000; ++i) {
            const Shape ground = Shape::half_space({random.direction(), random.number(-1, 1)}).value(),
                        box = random.box();
            const RigidTransform here{random.rotation(), random.direction()};
            RigidTransform there{random.rotation(), random.direction()};
            const Distance apart = distance({ground, here}, {box, there});
            const Penetration deep = penetration({ground, here}, {box, there});
            there.translation +=
                deep.depth * deep.normal - apart.distance * apart.normal;  // they touch but for rounding
            const bool meet = intersects({ground, here}, {box, there});
            CHECK((contact_manifold({ground, here}, {box, there}).count > 0) == meet);
            CHECK((contact_manifold({box, there}, {ground, here}).count > 0) == meet);
            CHECK(contact_manifold({ground, here}, {box, there}, {.margin = 1e-9}).count > 0);
            meeting += meet;
        }
        CHECK(meeting > 200);
        CHECK(meeting < 1800);
    }

    TEST_CASE("a needle that sinks in near the rim leaves the face for the side that is nearer") {
        RandomShapes random(18);
        std::vector<glm::vec3> corners;
        for (int i = 0; i < 8; ++i) corners.emplace_back(i & 1, i >> 1 & 1, i >> 2 & 1);
        const Hull cube = Hull::build(corners).value();
        const Shape shape = Shape::hull(cube);
        for (const glm::vec3& half : {glm::vec3(0, 1, 0), glm::vec3(0, 0, 0), glm::vec3(0.001f, 1, 0)}) {
            const Shape needle = Shape::box(half).value();
            PairCache cache;
            const double y = 0.7 + static_cast<double>(half.y);
            CHECK(contact_manifold({shape, at({})}, {needle, at({0.5, y, 0.5})}, {}, &cache).normal.y == 1.0);
            const Manifold m = contact_manifold({shape, at({})}, {needle, at({0.99, y, 0.5})}, {}, &cache);
            CHECK(m.normal.x == 1.0);
            CHECK(m.depth == doctest::Approx(0.01 + static_cast<double>(half.x)));
        }
    }

    TEST_CASE("a box in a half-space touches it with the corners below, and is as deep as it has to be lifted") {
        const Shape ground = Shape::half_space({{0.0, 0.0, -2.0}, 0.0}).value(), box = Shape::box({1, 1, 1}).value();
        const Manifold m = contact_manifold({ground, at({})}, {box, at({0.0, 0.0, 0.75})});
        CHECK(m.count == 4);
        CHECK(m.depth == doctest::Approx(0.25));
        CHECK(m.normal.z == doctest::Approx(1.0));
        CHECK(contact_manifold({ground, at({})}, {box, at({0.0, 0.0, 1.5})}).count == 0);
        const Manifold resting = contact_manifold({ground, at({})}, {box, at({0.0, 0.0, 1.0})});
        CHECK(resting.count == 4);
        CHECK(resting.depth == 0.0);
        CHECK(penetration({ground, at({})}, {box, at({0.0, 0.0, 0.5})}).depth == doctest::Approx(0.5));
        CHECK(distance({ground, at({})}, {box, at({0.0, 0.0, 1.5})}).distance == doctest::Approx(0.5));
    }
}
