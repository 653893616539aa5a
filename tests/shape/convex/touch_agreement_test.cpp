// SPDX-License-Identifier: MIT
// Shapes that touch within rounding: every query gives the same yes or no, in either order.
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <memory>
#include <vector>

#include "random_shapes.hpp"
#include "surfaces.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

// Whether one shape ends where the other begins, along the normal: told by all the queries alike.
void check_agreement(const ShapeAtPose& a, const ShapeAtPose& b, int& meeting) {
    const bool meet = intersects(a, b);
    meeting += meet;
    CHECK(intersects(b, a) == meet);
    const Distance d = distance(a, b);
    CHECK((d.distance == 0.0) == meet);
    CHECK((d.normal == glm::dvec3(0.0)) == meet);
    CHECK(d.lower <= d.distance);
    CHECK(d.distance <= d.upper + 1e-12);
    const bool corners = a.shape.has_polytope_core() && b.shape.has_polytope_core();
    CHECK(glm::distance(d.on_a, d.on_b) <= (corners ? 1e-11 : 1e-7) * 24.0);
    const Penetration p = penetration(a, b);
    CHECK(p.overlapping == meet);
    CHECK(p.depth >= 0.0);
    if (meet) CHECK(glm::length(p.normal) == doctest::Approx(1.0));
    const Manifold m = contact_manifold(a, b);
    CHECK((m.count > 0) == meet);
    if (meet) CHECK(m.depth >= 0.0);
    // Within a margin there are points in any case.
    CHECK(contact_manifold(a, b, {.margin = 1e-3}).count > 0);
    PairCache cache;
    for (int i = 0; i < 3; ++i) {
        CHECK(intersects(a, b, &cache) == meet);
        CHECK((distance(a, b, &cache).distance == 0.0) == meet);
        CHECK(penetration(a, b, &cache).overlapping == meet);
    }
    // Warm from a little deeper in.
    PairCache warm;
    const RigidTransform deeper{b.pose.rotation, b.pose.translation - 1e-3 * (meet ? p.normal : d.normal)};
    (void)contact_manifold(a, {b.shape, deeper}, {}, &warm);
    for (int i = 0; i < 2; ++i) CHECK((contact_manifold(a, b, {}, &warm).count > 0) == meet);
}

struct Kinds {
    Kinds() {
        const Shape box = Shape::box({.5f, .7f, .9f}).value(), cylinder = Shape::cylinder(.5f, .8f).value(),
                    triangle = Shape::triangle({-1, 0, -1}, {1, 0, -1}, {0, 0, 1}).value(),
                    cone = Shape::cone(.6f, .5f).value();
        RandomShapes random(3);
        hull = std::make_unique<Hull>(Hull::build(random.points(14)).value());
        const Shape of_points = Shape::hull(*hull);
        all = {Shape::sphere(.5).value(),
               Shape::sphere(0.0).value(),
               Shape::capsule(.6f, .3f).value(),
               Shape::capsule(.6f, 0.0f).value(),
               box,
               triangle,
               of_points,
               cylinder,
               cone,
               Shape::rounded(box, .2).value(),
               Shape::rounded(triangle, .2).value(),
               Shape::rounded(of_points, .1).value(),
               Shape::rounded(cylinder, .2).value(),
               Shape::rounded(cone, 1e-6).value(),
               Shape::rounded(box, 1e-13).value()};
    }
    std::unique_ptr<Hull> hull;
    std::vector<Shape> all;
};

// b stands so that it ends on a plane on which a ends.
RigidTransform touching_pose(RandomShapes& random, const Shape& a, const RigidTransform& pose, const Shape& b) {
    RigidTransform there{random.rotation(), {}};
    const glm::dvec3 n = random.direction();
    const glm::dvec3 p = pose.rotation * support_point(a, glm::transpose(pose.rotation) * n),
                     q = there.rotation * support_point(b, glm::transpose(there.rotation) * -n);
    there.translation = pose.translation + (p - q);
    return there;
}

}  // namespace

TEST_SUITE("convex/touch_agreement") {
    TEST_CASE("shapes that touch within rounding meet for all queries or for none, in either order, warm or cold") {
        RandomShapes random(17);
        const Kinds kinds;
        int meeting = 0, asked = 0;
        for (std::size_t i = 0; i < kinds.all.size(); ++i)
            for (std::size_t j = 0; j < kinds.all.size(); ++j) {
                CAPTURE(i);
                CAPTURE(j);
                for (int k = 0; k < 150; ++k, ++asked) {
                    const RigidTransform pose{random.rotation(),
                                              k % 3 == 0 ? glm::dvec3(0.0) : 10.0 * random.direction()};
                    const RigidTransform there = touching_pose(random, kinds.all[i], pose, kinds.all[j]);
                    check_agreement({kinds.all[i], pose}, {kinds.all[j], there}, meeting);
                }
            }
        CHECK(meeting > asked / 10);
        CHECK(meeting < asked * 9 / 10);
    }

    TEST_CASE("compounds and surfaces that touch a shape within rounding meet it for all queries or for none") {
        RandomShapes random(18);
        const Kinds kinds;
        int meeting = 0, asked = 0;
        for (std::size_t i = 0; i < kinds.all.size(); ++i)
            for (std::size_t j = 0; j < kinds.all.size(); ++j) {
                CAPTURE(i);
                CAPTURE(j);
                for (int k = 0; k < 20; ++k) {
                    const CompoundChild children[] = {{kinds.all[i], {random.rotation(), 3.0 * random.direction()}},
                                                      {kinds.all[j], {random.rotation(), 40.0 * random.direction()}}};
                    const Compound compound = Compound::build(children).value();
                    const Shape whole = Shape::compound(compound);
                    const RigidTransform pose{random.rotation(), std::pow(10.0, k % 7) * random.direction()};
                    const RigidTransform part{pose.rotation * children[0].pose.rotation,
                                              pose.rotation * children[0].pose.translation + pose.translation};
                    const RigidTransform there = touching_pose(random, kinds.all[i], part, kinds.all[j]);
                    const ShapeAtPose a{whole, pose}, b{kinds.all[j], there};
                    const bool meet = intersects({kinds.all[i], part}, b);
                    CHECK(intersects(a, b) == meet);
                    CHECK(intersects(b, a) == meet);
                    CHECK((distance(a, b).distance == 0.0) == meet);
                    CHECK(penetration(a, b).overlapping == meet);
                    CHECK((contact_manifold(a, b).count > 0) == meet);
                    meeting += meet;
                    ++asked;
                }
            }
        CHECK(meeting > asked / 10);
        CHECK(meeting < asked * 9 / 10);
    }

    TEST_CASE("a shape that touches a mesh within rounding has a contact iff it meets it") {
        RandomShapes random(19);
        const Kinds kinds;
        int meeting = 0, asked = 0;
        for (int round = 0; round < 40; ++round) {
            const Surface mesh = tangle(random, 4, 6);
            for (std::size_t i = 0; i < kinds.all.size(); ++i)
                for (int k = 0; k < 4; ++k) {
                    CAPTURE(i);
                    const RigidTransform pose{random.rotation(), 10.0 * random.direction()};
                    RigidTransform there{random.rotation(), pose.translation + 6.0 * random.direction()};
                    const ShapeAtPose a{mesh.shape(), pose};
                    // Twice, as the nearest points move on a little.
                    for (int step = 0; step < 2; ++step) {
                        const Distance d = distance(a, {kinds.all[i], there});
                        there.translation -= d.distance * d.normal;
                    }
                    const ShapeAtPose b{kinds.all[i], there};
                    const bool meet = intersects(a, b);
                    CHECK(intersects(b, a) == meet);
                    CHECK((distance(a, b).distance == 0.0) == meet);
                    CHECK(penetration(a, b).overlapping == meet);
                    CHECK((contact_manifold(a, b).count > 0) == meet);
                    Manifolds found;
                    contact_manifolds(b, a, {}, found);
                    CHECK(found.all().empty() != meet);
                    meeting += meet;
                    ++asked;
                }
        }
        CHECK(meeting > asked / 20);
        CHECK(meeting < asked * 19 / 20);
    }
}
