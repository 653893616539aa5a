// SPDX-License-Identifier: MIT
// Manifolds where one shape touches with a segment: a side of what is round, an edge, a triangle without area.
#include <doctest/doctest.h>
#include <crofton/convex/query.hpp>

#include "contact_ids.hpp"
#include "random_shapes.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

TEST_SUITE("convex/segment_manifold") {
    TEST_CASE("a capsule that lies across a box has one point above each of two edges") {
        const Shape box = Shape::box({1, 1, 1}).value(), capsule = Shape::capsule(3, 0.5f).value();
        for (const double shift : {0.0, 2.5, -3.0}) {
            CAPTURE(shift);
            const RigidTransform ground = at({}),
                                 lying{glm::mat3_cast(glm::angleAxis(1.5707963267948966, glm::dvec3(0, 0, 1))),
                                       {shift, 1.4, 0.25}};
            for (const bool first : {true, false}) {
                const ShapeAtPose low{box, ground}, high{capsule, lying};
                const Manifold m = first ? contact_manifold(low, high) : contact_manifold(high, low);
                REQUIRE(m.count == 2);
                CHECK(ids(m).size() == 2);
                CHECK(m.depth == doctest::Approx(0.1));
                const double left = std::max(-1.0, shift - 3.0), right = std::min(1.0, shift + 3.0);
                const bool turned = m.points[0].position.x > m.points[1].position.x;
                CHECK(m.points[turned].position.x == doctest::Approx(left));
                CHECK(m.points[!turned].position.x == doctest::Approx(right));
                for (int i = 0; i < 2; ++i) {
                    CHECK(m.points[i].position.y == doctest::Approx(0.95));
                    CHECK(m.points[i].position.z == doctest::Approx(0.25));
                }
            }
        }
    }

    TEST_CASE("points of capsules, cylinders and cones on boxes, hulls and triangles differ in their ids") {
        RandomShapes random(7);
        int points = 0;
        for (int i = 0; i < 2000; ++i) {
            const float height = static_cast<float>(random.number(0.2, 2.0));
            const Shape round = i % 3 == 0   ? Shape::capsule(height, 0.3f).value()
                                : i % 3 == 1 ? Shape::cylinder(height, 0.3f).value()
                                             : Shape::cone(height, 0.3f).value();
            const Shape flat = random.polytope(24);
            const CasePair where = nearly_touching(random, flat, round, -std::pow(10.0, random.number(-6, -1)), 0.0);
            const Manifold m = contact_manifold({flat, where.pose_a}, {round, where.pose_b}, {.max_points = 8});
            CAPTURE(i);
            CHECK(ids(m).size() == static_cast<std::size_t>(m.count));
            points += m.count;
        }
        CHECK(points > 2000);
    }

    TEST_CASE("points lie on a triangle whose corners are in line, and on one that is nearly so") {
        RandomShapes random(8);
        const Shape box = Shape::box({0.8f, 1.1f, 0.6f}).value();
        int points = 0;
        for (int i = 0; i < 2000; ++i) {
            // Corners with rounded coordinates in the world, in any order along the line.
            const float width = i % 2 == 0 ? 0.0f : static_cast<float>(std::pow(10.0, random.number(-12, -2)));
            glm::vec3 corners[] = {{2, 0, 0}, {0, 0, 2}, {1, width, 1}};
            std::swap(corners[2], corners[random.index(3)]);
            const Shape sliver = Shape::triangle(corners[0], corners[1], corners[2]).value();
            const CasePair where = nearly_touching(random, box, sliver, -std::pow(10.0, random.number(-6, -1)), 0.0);
            const ShapeAtPose pa{box, where.pose_a}, pb{sliver, where.pose_b};
            const Manifold m = contact_manifold(pa, pb, {.max_points = 8});
            CAPTURE(i);
            for (int k = 0; k < m.count; ++k) {
                const glm::dvec3 half = 0.5 * m.points[k].depth * m.normal;
                CHECK(closest_point(pa, m.points[k].position + half).distance <= 1e-8);
                CHECK(closest_point(pb, m.points[k].position - half).distance <= 1e-8);
            }
            points += m.count;
        }
        CHECK(points > 2000);
    }
}
