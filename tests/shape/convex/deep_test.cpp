// SPDX-License-Identifier: MIT
// Spheres and capsules whose core lies deep in another shape: every field of the answers, by formulas and exactly.
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <memory>
#include <oracle/exact_convex.hpp>
#include <vector>

#include "penetration_fields.hpp"
#include "random_shapes.hpp"
#include "surfaces.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

// As far from a rotation as a pose may be.
glm::dmat3 skewed(RandomShapes& random, glm::dmat3 rotation) {
    for (int k = 0; k < 3; ++k) rotation[k] += 2e-7 * random.direction();
    return rotation;
}

struct DeepCase {
    Shape a, b;
    RigidTransform pose_a, pose_b;
    double tolerance = 1e-9;  // of the size
    [[nodiscard]] ShapeAtPose first() const { return {a, pose_a}; }
    [[nodiscard]] ShapeAtPose second() const { return {b, pose_b}; }
    [[nodiscard]] double size() const {
        return a.core_radius() + b.core_radius() + a.radius() + b.radius() +
               glm::distance(pose_a.translation, pose_b.translation);
    }
};

void check_penetration(const DeepCase& c, const Penetration& p, RandomShapes& random) {
    check_penetration_fields(c.first(), c.second(), p, c.tolerance * c.size(), c.size(), random);
}

void check_manifold(const DeepCase& c, const Penetration& p) {
    const double slack = 2.0 * c.tolerance * c.size();
    const Manifold m = contact_manifold(c.first(), c.second(), {.max_points = 8});
    REQUIRE(m.count > 0);
    CHECK(m.depth == doctest::Approx(p.depth).epsilon(1e-12));
    CHECK(m.normal == p.normal);
    double deepest = -HUGE_VAL;
    for (int k = 0; k < m.count; ++k) {
        deepest = std::max(deepest, m.points[k].depth);
        const glm::dvec3 half = 0.5 * m.points[k].depth * m.normal;
        // A hull's faces are flat to 1e-5 alone.
        const double flat = c.a.hull() != nullptr || c.b.hull() != nullptr ? 1e-5 * c.size() : 0.0;
        CHECK(closest_point(c.first(), m.points[k].position + half).distance <= slack + flat);
        CHECK(closest_point(c.second(), m.points[k].position - half).distance <= slack + flat);
        CHECK(m.points[k].part_a == PartId{});
        CHECK(m.points[k].part_b == PartId{});
    }
    CHECK(deepest == m.depth);
    PairCache cache;
    for (int i = 0; i < 2; ++i) {
        const Manifold warm = contact_manifold(c.first(), c.second(), {.max_points = 8}, &cache);
        CHECK(std::abs(warm.depth - m.depth) <= slack);
    }
}

void check_meeting(const DeepCase& c) {
    CHECK(intersects(c.first(), c.second()));
    const Distance d = distance(c.first(), c.second());
    CHECK(d.distance == 0.0);
    CHECK(d.normal == glm::dvec3(0.0));
    CHECK(d.on_a == d.on_b);
    CHECK(closest_point(c.first(), d.on_a).distance <= 1e-9 * c.size());
    CHECK(closest_point(c.second(), d.on_b).distance <= 1e-9 * c.size());
}

// The thin shape's middle is a point of the solid: anywhere, or beside its surface.
DeepCase random_case(RandomShapes& random, const Shape& solid, const Shape& thin) {
    DeepCase c{solid, thin, {random.rotation(), 5.0 * random.direction()}, {random.rotation(), {}}};
    if (random.index(3) == 0) {
        c.pose_a.rotation = skewed(random, c.pose_a.rotation);
        c.pose_b.rotation = skewed(random, c.pose_b.rotation);
    }
    if (random.index(4) == 0) c.pose_b.rotation = c.pose_a.rotation;  // along an edge or axis
    const glm::dvec3 to = support_point(solid, random.direction()), other = support_point(solid, random.direction());
    const double share = random.index(2) == 0 ? random.number(0, 1) : 1.0 - std::pow(10.0, random.number(-9, 0)),
                 blend = random.number(0, 1);
    glm::dvec3 local = share * (blend * to + (1.0 - blend) * other);
    if (random.index(10) == 0) local = glm::dvec3(0.0);
    if (random.index(5) == 0) local.y = 0.0;
    c.pose_b.translation = c.pose_a.rotation * local + c.pose_a.translation;
    return c;
}

DeepCase swapped(const DeepCase& c) {
    return {c.b, c.a, c.pose_b, c.pose_a, c.tolerance};
}

}  // namespace

TEST_SUITE("convex/deep") {
    TEST_CASE(
        "a sphere or capsule deep in a box or hull: every field is that of the shortest way out, in either order") {
        RandomShapes random(41);
        int asked = 0;
        for (int i = 0; i < 6000; ++i) {
            const Shape core = i % 2 == 0 ? random.box() : random.hull(4 + random.index(20));
            const Shape solid = i % 5 == 0 ? Shape::rounded(core, random.number(0, 0.3)).value() : core;
            const Shape thin = i % 3 == 0 ? Shape::sphere(random.number(0, 0.5)).value()
                               : i % 3 == 1
                                   ? Shape::capsule(float(random.number(0, 0.5)), float(random.number(0, 0.3))).value()
                                   : Shape::sphere(0.2).value();
            const DeepCase c = random_case(random, solid, thin);
            if (!intersects(c.first(), c.second())) continue;
            CAPTURE(i);
            for (const DeepCase& ordered : {c, swapped(c)}) {
                const Penetration p = penetration(ordered.first(), ordered.second());
                check_penetration(ordered, p, random);
                check_manifold(ordered, p);
                check_meeting(ordered);
            }
            ++asked;
        }
        CHECK(asked > 4000);
    }

    TEST_CASE("their depths lie between the bounds as exact integers have them") {
        RandomShapes random(42);
        for (int i = 0; i < 300; ++i) {
            const bool box = i % 2 == 0;
            const Shape solid = box ? random.box() : random.hull(4 + random.index(8));
            const Shape thin = box && i % 4 == 0 ? Shape::capsule(float(random.number(0, 0.5)), 0.0f).value()
                                                 : Shape::sphere(0.0).value();
            const DeepCase c = random_case(random, solid, thin);
            if (!intersects(c.first(), c.second())) continue;
            const Penetration p = penetration(c.first(), c.second());
            const double exact = std::sqrt(
                oracle::squared_depth(oracle::exact_polytope(c.first()), oracle::exact_polytope(c.second())).get_d());
            CAPTURE(i);
            CHECK(p.lower <= exact * (1.0 + 1e-14));
            CHECK(exact <= p.upper * (1.0 + 1e-14));
        }
    }

    TEST_CASE("a sphere deep in a cylinder or cone leaves it across a disc or the side, as the formula says") {
        RandomShapes random(43);
        for (int i = 0; i < 6000; ++i) {
            const bool cone = i % 2 == 0;
            const double half = random.number(0.1, 1.0), radius = random.number(0.1, 1.0),
                         rounding = random.number(0, 0.2);
            const Shape core = cone ? Shape::cone(float(half), float(radius)).value()
                                    : Shape::cylinder(float(half), float(radius)).value();
            const double h = double(float(half)), r = double(float(radius));
            const Shape solid = i % 3 == 0 ? Shape::rounded(core, rounding).value() : core;
            DeepCase c = random_case(random, solid, Shape::sphere(0.3).value());
            const bool is_rigid =
                glm::distance(glm::transpose(c.pose_a.rotation)[0] * c.pose_a.rotation, glm::dvec3(1, 0, 0)) < 1e-14;
            const glm::dvec3 local = glm::inverse(c.pose_a.rotation) * (c.pose_b.translation - c.pose_a.translation);
            const double off_axis = std::hypot(local.x, local.z), slant = std::hypot(2.0 * h, r);
            const double to_disc = cone ? local.y + h : h - std::abs(local.y),
                         to_side = cone ? (r * (h - local.y) - 2.0 * h * off_axis) / slant : r - off_axis;
            if (std::min(to_disc, to_side) < 1e-6) continue;
            c.tolerance = 1e-5;
            CAPTURE(i);
            for (const DeepCase& ordered : {c, swapped(c)}) {
                const Penetration p = penetration(ordered.first(), ordered.second());
                const double expected = std::min(to_disc, to_side) + solid.radius() + 0.3;
                CHECK(std::abs(p.depth - expected) <= (is_rigid ? 1e-13 : 1e-5));
                CHECK(p.upper - p.lower <= (is_rigid ? 1e-12 : 1e-5));
                check_penetration(ordered, p, random);
                check_manifold(ordered, p);
                check_meeting(ordered);
                if (std::abs(to_disc - to_side) < 1e-4 || off_axis < 1e-4) continue;
                const glm::dvec3 radial(local.x / off_axis, 0.0, local.z / off_axis);
                glm::dvec3 out = cone ? (2.0 * h * radial + glm::dvec3(0, r, 0)) / slant : radial;
                if (to_disc < to_side) out = {0.0, cone || local.y < 0.0 ? -1.0 : 1.0, 0.0};
                out = c.pose_a.rotation * out;
                CHECK(glm::distance(p.normal, ordered.a.kind() == Kind::sphere ? -out : out) <= 1e-5);
            }
        }
    }

    TEST_CASE(
        "a sphere or capsule deep in a child of a compound, or in a room of twelve triangles, leaves by the nearest "
        "wall") {
        RandomShapes random(44);
        Surface room;
        for (int i = 0; i < 8; ++i)
            room.mesh.positions.emplace_back((i & 1) != 0 ? 2 : -2, (i & 2) != 0 ? 2 : -2, (i & 4) != 0 ? 2 : -2);
        room.mesh.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                             2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
        room.build();
        const Shape box = Shape::box({1, 1.2f, 1.4f}).value();
        int meeting = 0;
        for (int i = 0; i < 3000; ++i) {
            const Shape thin = i % 2 == 0 ? Shape::sphere(0.4).value() : Shape::capsule(0.3f, 0.2f).value();
            const DeepCase alone = random_case(random, box, thin);
            const CompoundChild children[] = {{box, {random.rotation(), random.direction()}},
                                              {box, {glm::dmat3(1.0), {40, 0, 0}}}};
            const Compound compound = Compound::build(children).value();
            const Shape whole = Shape::compound(compound);
            // The compound stands so that its first child is the box, but for rounding.
            RigidTransform pose;
            pose.rotation = alone.pose_a.rotation * glm::inverse(children[0].pose.rotation);
            pose.translation = alone.pose_a.translation - pose.rotation * children[0].pose.translation;
            CAPTURE(i);
            if (intersects(alone.first(), alone.second())) {
                const Penetration p = penetration({whole, pose}, alone.second()),
                                  expected = penetration(alone.first(), alone.second());
                CHECK(p.overlapping);
                CHECK(std::abs(p.depth - expected.depth) <= 1e-9);
                CHECK(p.lower <= p.depth);
                CHECK(glm::distance(p.on_a - p.on_b, p.depth * p.normal) <= 1e-9);
                CHECK(p.part_a == PartId{0, 0});
            }
            const RigidTransform here{random.rotation(), random.direction()};
            RigidTransform there{random.rotation(), {}};
            // The core stays within the room.
            const glm::dvec3 local(random.number(-1.69, 1.69), random.number(-1.69, 1.69), random.number(-1.69, 1.69));
            there.translation = here.rotation * local + here.translation;
            // Every wall that is nearer than the shape reaches is one manifold, as deep as that.
            double most = 0.0;
            for (int k = 0; k < 3; ++k)
                for (const double side : {-1.0, 1.0}) {
                    const double reach = reach_along({thin, there}, side * here.rotation[k]) -
                                         side * glm::dot(here.rotation[k], here.translation);
                    most = std::max(most, reach - 2.0);
                }
            Manifolds found;
            contact_manifolds({room.shape(), here}, {thin, there}, {}, found);
            CHECK(intersects({room.shape(), here}, {thin, there}) == (most > 0.0));
            CHECK(intersects({thin, there}, {room.shape(), here}) == (most > 0.0));
            CHECK(found.all().empty() == (most <= 0.0));
            double deepest = 0.0;
            for (const Manifold& m : found.all()) deepest = std::max(deepest, m.depth);
            CHECK(std::abs(deepest - most) <= 1e-9);
            meeting += most > 0.0;
        }
        CHECK(meeting > 300);
    }
}
