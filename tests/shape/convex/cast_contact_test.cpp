// SPDX-License-Identifier: MIT
// What a cast tells beside the time: the points, the normal, the distance, the parts; and casts that begin in contact.
#include <doctest/doctest.h>
#include <crofton/convex/query.hpp>
#include <memory>
#include <oracle/impacts.hpp>
#include <string>
#include <vector>

#include "random_shapes.hpp"
#include "surfaces.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

struct NamedShape {
    std::string name;
    Shape shape;
};

// One of each convex kind, round ones and those with a rounding.
std::vector<NamedShape> convex_kinds(RandomShapes& random) {
    const float r = static_cast<float>(random.number(0.2, 0.9)), h = static_cast<float>(random.number(0.2, 0.9));
    const Shape box = random.box(), hull = random.hull(20), cylinder = Shape::cylinder(h, r).value(),
                cone = Shape::cone(h, r).value(), triangle = random.polytope(4);
    const glm::vec3 p[3] = {glm::vec3(random.direction()), glm::vec3(random.direction()),
                            glm::vec3(random.direction())};
    const Shape flat = Shape::triangle(p[0], p[1], p[2]).value();
    return {{"sphere", Shape::sphere(r).value()},
            {"capsule", Shape::capsule(h, r).value()},
            {"box", box},
            {"hull", hull},
            {"triangle", flat},
            {"polytope", triangle},
            {"cylinder", cylinder},
            {"cone", cone},
            {"rounded box", Shape::rounded(box, 0.2).value()},
            {"rounded hull", Shape::rounded(hull, 0.1).value()},
            {"rounded triangle", Shape::rounded(flat, 0.1).value()},
            {"rounded cylinder", Shape::rounded(cylinder, 0.15).value()},
            {"rounded cone", Shape::rounded(cone, 0.15).value()}};
}

double degrees_between(const glm::dvec3& u, const glm::dvec3& v) {
    return std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v)) * 57.29577951308232;
}

double size_of(const ShapeAtPose& a, const ShapeAtPose& b) {
    const auto reach = [](const Shape& shape) {
        return shape.kind() == Kind::half_space ? 0.0 : shape.core_radius() + shape.radius();
    };
    return reach(a.shape) + reach(b.shape) + glm::distance(a.pose.translation, b.pose.translation);
}

bool is_hard(const Shape& shape) {
    return shape.kind() == Kind::cylinder || shape.kind() == Kind::cone;
}

// All fields of a hit between two convex shapes.
void check_hit(const ShapeAtPose& a, const Motion& ma, const ShapeAtPose& b, const Motion& mb, const Impact& i,
               const CastOptions& options) {
    const RigidTransform now_a = moved(a.pose, ma, i.time), now_b = moved(b.pose, mb, i.time);
    const ShapeAtPose then_a{a.shape, now_a}, then_b{b.shape, now_b};
    const double size = size_of(then_a, then_b);
    const double slack =
        (is_hard(a.shape) || is_hard(b.shape) ? 4e-9 : 1e-12) * size + 1e-15 * glm::length(now_a.translation);
    CHECK(oracle::fault_of_contact(then_a, then_b, i, slack) == "");
    CHECK(i.distance >= 0.0);
    CHECK(i.distance < options.tolerance);
    // A sphere's normal, by formula.
    if (b.shape.kind() == Kind::sphere)
        if (const glm::dvec3 n = oracle::direction_to_point(then_a, now_b.translation); n != glm::dvec3(0.0))
            CHECK(degrees_between(n, i.normal) < 0.01);
    // What `distance` says there.
    const Distance d = distance(then_a, then_b);
    if (d.distance > 0.0) CHECK(degrees_between(d.normal, i.normal) < 0.1);
}

}  // namespace

TEST_SUITE("convex/cast_contact") {
    TEST_CASE("for all pairs of kinds, hit points lie on both shapes and the normal separates them") {
        RandomShapes random(71);
        int hits = 0, misses = 0;
        for (int round = 0; round < 200; ++round) {
            const std::vector<NamedShape> kinds = convex_kinds(random);
            const double offset = round % 4 == 3 ? 1e4 : 0.0;
            for (const NamedShape& first : kinds)
                for (const NamedShape& second : kinds) {
                    CAPTURE(first.name);
                    CAPTURE(second.name);
                    const glm::dvec3 place = offset * random.direction();
                    const RigidTransform pose_a{random.rotation(), place},
                        pose_b{random.rotation(), place + 5.0 * random.direction()};
                    const ShapeAtPose a{first.shape, pose_a}, b{second.shape, pose_b};
                    Motion ma{random.number(0, 3) * random.direction(), {}, {}}, mb{};
                    mb.velocity = ma.velocity + 1.6 * (place - pose_b.translation) + 1.2 * random.direction();
                    const bool turns = round % 2 == 1;
                    if (turns) {
                        ma.spin = random.number(0, 4) * random.direction();
                        mb.spin = random.number(0, 4) * random.direction();
                        mb.pivot = 0.3 * random.direction();
                    }
                    const CastOptions options;
                    const Impact i = cast(a, ma, b, mb, options).value();
                    REQUIRE(i.result != CastResult::unresolved);
                    const auto gap_at = [&](double t) {
                        const RigidTransform now_a = moved(pose_a, ma, t), now_b = moved(pose_b, mb, t);
                        return distance({first.shape, now_a}, {second.shape, now_b}).distance;
                    };
                    if (i.result == CastResult::miss) {
                        ++misses;
                        CHECK(i.time == 1.0);
                        CHECK(i.normal == glm::dvec3(0.0));
                        CHECK(i.on_a == glm::dvec3(0.0));
                        CHECK(i.on_b == glm::dvec3(0.0));
                        CHECK(i.distance == 0.0);
                        double t = 0.0;
                        for (int k = 0; k <= 8; ++k)
                            if (gap_at(k / 8.0) < gap_at(t)) t = k / 8.0;
                        CHECK(gap_at(t) > 0.0);
                        continue;
                    }
                    ++hits;
                    check_hit(a, ma, b, mb, i, options);
                    // No touch before.
                    for (int k = 0; k < 4; ++k) CHECK(gap_at(i.time * k / 4.0) > 0.0);
                    // The other order tells the same.
                    const Impact back = cast(b, mb, a, ma, options).value();
                    REQUIRE(back.result == CastResult::hit);
                    check_hit(b, mb, a, ma, back, options);
                }
        }
        CHECK(hits > 20000);
        CHECK(misses > 2000);
    }

    TEST_CASE("casts at half-spaces return the point on the ground under the shape, in either order") {
        RandomShapes random(72);
        const Plane plane{{0.2, 1.0, -0.3}, 0.4};
        const Shape half = Shape::half_space(plane).value();
        for (int round = 0; round < 40; ++round)
            for (const NamedShape& kind : convex_kinds(random)) {
                CAPTURE(kind.name);
                const RigidTransform pose{random.rotation(), {0, -5, 0}}, rest;
                Motion motion{{0, 20, 0}, {}, {}};
                if (round % 2 == 1) motion.spin = 5.0 * random.direction();
                const Impact i = cast({half, rest}, {}, {kind.shape, pose}, motion).value();
                REQUIRE(i.result == CastResult::hit);
                check_hit({half, rest}, {}, {kind.shape, pose}, motion, i, {});
                const Impact back = cast({kind.shape, pose}, motion, {half, rest}, {}).value();
                REQUIRE(back.result == CastResult::hit);
                check_hit({kind.shape, pose}, motion, {half, rest}, {}, back, {});
            }
    }

    TEST_CASE("casts at shapes of parts return the points, the normal and the first part") {
        RandomShapes random(73);
        int hits = 0;
        for (int round = 0; round < 60; ++round) {
            const Surface s = soup(random, 30, 1.5, 0.6);
            std::vector<float> heights;
            for (int k = 0; k < 36; ++k) heights.push_back(static_cast<float>(random.number(-0.4, 0.4)));
            const HeightField field =
                HeightField::build({.columns = 6, .rows = 6, .heights = heights, .spacing = {0.7, 0.6}}).value();
            std::vector<CompoundChild> children;
            for (const NamedShape& kind : convex_kinds(random))
                children.push_back({kind.shape, {random.rotation(), 1.5 * random.direction()}});
            children.push_back({s.shape(), {random.rotation(), glm::dvec3(0.0)}});
            const Compound compound = Compound::build(children).value();
            const Shape shapes[] = {s.shape(), Shape::height_field(field, Sides::both), Shape::compound(compound)};
            for (const Shape& shape : shapes)
                for (const NamedShape& kind : convex_kinds(random)) {
                    CAPTURE(kind.name);
                    const RigidTransform pose{random.rotation(), random.direction()},
                        from{random.rotation(), pose.translation + 7.0 * random.direction()};
                    const Motion motion{
                        1.7 * (pose.translation - from.translation), 0.5 * (round % 3) * random.direction(), {}};
                    const ShapeAtPose placed{shape, pose}, mover{kind.shape, from};
                    const Impact i = cast(placed, {}, mover, motion).value();
                    if (i.result != CastResult::hit || i.time == 0.0) continue;
                    ++hits;
                    const RigidTransform then = moved(from, motion, i.time);
                    Vector<Part> near;
                    parts_near(placed, {kind.shape, then}, 0.01, near);
                    bool found = false;
                    for (const Part& part : near) {
                        if (part.id != i.part_a) continue;
                        found = true;
                        check_hit({part.shape, part.pose}, {}, mover, motion, i, {});
                    }
                    CHECK(found);
                    const Impact back = cast(mover, motion, placed, {}).value();
                    REQUIRE(back.result == CastResult::hit);
                    CHECK(std::abs(back.time - i.time) * glm::length(motion.velocity) < 1e-4);
                    if (back.part_b == i.part_a) CHECK(degrees_between(back.normal, -i.normal) < 0.1);
                }
        }
        CHECK(hits > 1000);
    }

    TEST_CASE(
        "after a hit: away and along is a miss, and into the wall a hit at once with its normal and the true gap") {
        RandomShapes random(74);
        int casts = 0;
        for (int round = 0; round < 60; ++round)
            for (const NamedShape& wall : convex_kinds(random))
                for (const NamedShape& kind : convex_kinds(random)) {
                    CAPTURE(wall.name);
                    CAPTURE(kind.name);
                    const RigidTransform here{random.rotation(), 2.0 * random.direction()},
                        from{random.rotation(), here.translation + 5.0 * random.direction()};
                    const Motion fly{1.3 * (here.translation - from.translation), {}, {}};
                    const ShapeAtPose placed{wall.shape, here};
                    const Impact first = cast(placed, {}, {kind.shape, from}, fly).value();
                    if (first.result != CastResult::hit) continue;
                    ++casts;
                    const RigidTransform there = moved(from, fly, first.time);
                    const ShapeAtPose mover{kind.shape, there};
                    const auto go = [&](const glm::dvec3& way, const CastOptions& options = {}) {
                        const Impact i = cast(placed, {}, mover, {way, {}, {}}, options).value();
                        const Impact back = cast(mover, {way, {}, {}}, placed, {}, options).value();
                        CHECK(back.result == i.result);
                        return i;
                    };
                    const glm::dvec3 n = first.normal, side = glm::normalize(glm::cross(n, random.direction()));
                    CHECK(go(3.0 * n).result == CastResult::miss);
                    CHECK(go(2.0 * side + n).result == CastResult::miss);
                    CHECK(go(2.0 * side).result == CastResult::miss);
                    const Impact in = go(-3.0 * n);
                    REQUIRE(in.result == CastResult::hit);
                    CHECK(in.time == 0.0);
                    check_hit(placed, {}, mover, {-3.0 * n, {}, {}}, in, {});
                    CHECK(std::abs(in.distance - first.distance) < 1e-8);
                    CHECK(go(-3.0 * n, {.ignore_initial_overlaps = true}).result == CastResult::miss);
                }
        CHECK(casts > 5000);
    }

    TEST_CASE(
        "a shape on the ground may spin about the normal, roll along and lift off, and hits at once if it falls in") {
        const Shape slab = Shape::box({50, 1, 50}).value(), half = Shape::half_space({{0, -1, 0}, 0}).value();
        const RigidTransform low = at({0, -1, 0}), zero;
        const glm::dmat3 lying(glm::dvec3(0, 1, 0), glm::dvec3(1, 0, 0), glm::dvec3(0, 0, -1));
        struct Stand {
            Shape shape;
            glm::dmat3 rotation;
            double height;
            glm::dvec3 spin;
        };
        const Shape hull_free = Shape::box({0.3f, 0.4f, 0.5f}).value();
        const Stand stands[] = {
            {Shape::box({0.5f, 0.25f, 0.5f}).value(), glm::dmat3(1.0), 0.25, {0, 7, 0}},
            {hull_free, glm::dmat3(1.0), static_cast<double>(0.4f), {0, -20, 0}},
            {Shape::sphere(0.5).value(), glm::dmat3(1.0), 0.5, {4, 2, 1}},
            {Shape::capsule(0.5f, 0.25f).value(), glm::dmat3(1.0), 0.75, {0, 3, 0}},
            {Shape::capsule(0.5f, 0.25f).value(), lying, 0.25, {6, 0, 0}},
            {Shape::cylinder(0.5f, 0.25f).value(), glm::dmat3(1.0), 0.5, {0, 9, 0}},
            {Shape::cylinder(0.5f, 0.25f).value(), lying, 0.25, {8, 0, 0}},
            {Shape::cone(0.5f, 0.25f).value(), glm::dmat3(1.0), 0.5, {0, 5, 0}},
        };
        for (const double gap : {5e-7, 1e-9, 0.0})
            for (const Stand& stand : stands)
                for (const bool is_half : {false, true}) {
                    CAPTURE(gap);
                    CAPTURE(stand.height);
                    CAPTURE(is_half);
                    const ShapeAtPose floor{is_half ? half : slab, is_half ? zero : low};
                    const RigidTransform pose{stand.rotation, {0, stand.height + gap, 0}};
                    const auto go = [&](const glm::dvec3& velocity, const glm::dvec3& spin) {
                        return cast({stand.shape, pose}, {velocity, spin, {}}, floor, {}).value();
                    };
                    CHECK(go({3, 0, 1}, {}).result == CastResult::miss);
                    CHECK(go({3, 0, 1}, stand.spin).result == CastResult::miss);
                    CHECK(go({1, 2, 1}, {}).result == CastResult::miss);
                    CHECK(go({0, 1, 0}, stand.spin).result == CastResult::miss);
                    for (const Impact& i : {go({1, -2, 0}, {}), go({0, -1, 0}, stand.spin)}) {
                        REQUIRE(i.result == CastResult::hit);
                        CHECK(i.time == 0.0);
                        CHECK(i.normal.y == doctest::Approx(-1.0).epsilon(1e-9));
                        CHECK(std::abs(i.distance - gap) < 1e-12);
                    }
                }
    }

    TEST_CASE("along a floor of many parts nothing is hit: triangles, cells, boxes side by side") {
        RandomShapes random(75);
        const Surface flat = ground(random, 20, 0.5, [](double, double) { return 0.0; });
        const std::vector<float> zeros(21 * 21, 0.0f);
        const HeightField field =
            HeightField::build({.columns = 21, .rows = 21, .heights = zeros, .spacing = {0.5, 0.5}}).value();
        std::vector<CompoundChild> boxes;
        const Shape tile = Shape::box({0.5f, 0.5f, 0.5f}).value();
        for (int x = -5; x <= 5; ++x)
            for (int z = -5; z <= 5; ++z) boxes.push_back({tile, at({x, -0.5, z})});
        const Compound tiles = Compound::build(boxes).value();
        struct Floor {
            Shape shape;
            RigidTransform pose;
        };
        const Floor floors[] = {{flat.shape(), at({})},
                                {flat.shape(Sides::front), at({})},
                                {Shape::height_field(field), at({-5, 0, -5})},
                                {Shape::compound(tiles), at({})}};
        for (const Floor& floor : floors)
            for (int i = 0; i < 60; ++i)
                for (const NamedShape& kind : convex_kinds(random)) {
                    CAPTURE(kind.name);
                    // As far above as a cast stops, turned at random or upright.
                    RigidTransform pose{i % 2 == 0 ? random.rotation() : glm::dmat3(1.0),
                                        {random.number(-2, 2), 3.0, random.number(-2, 2)}};
                    const Impact fall =
                        cast({kind.shape, pose}, {{0, -4, 0}, {}, {}}, {floor.shape, floor.pose}, {}).value();
                    REQUIRE(fall.result == CastResult::hit);
                    CHECK(fall.normal.y < -0.9999);
                    pose.translation.y -= 4.0 * fall.time;
                    const glm::dvec3 way(random.number(-2, 2), 0, random.number(-2, 2));
                    const auto go = [&](const glm::dvec3& velocity) {
                        return cast({kind.shape, pose}, {velocity, {}, {}}, {floor.shape, floor.pose}, {}).value();
                    };
                    CHECK(go(way).result == CastResult::miss);
                    CHECK(go(way + glm::dvec3(0, 0.1, 0)).result == CastResult::miss);
                    const Impact in = go(way - glm::dvec3(0, 2, 0));
                    REQUIRE(in.result == CastResult::hit);
                    CHECK(in.time == 0.0);
                    CHECK(in.normal.y < -0.9999);
                }
    }

    TEST_CASE("shapes that begin overlapping are a hit at once, with the shortest way out, or they are left out") {
        RandomShapes random(76);
        int overlaps = 0;
        // Every third round faces lie along each other, so that many points are equally deep.
        const auto rotation = [&](int round) {
            const glm::dmat3 turn(glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0));
            if (round % 3 != 2) return random.rotation();
            return random.number(0, 1) < 0.5 ? turn : glm::dmat3(1.0);
        };
        const glm::vec3 corners[3] = {{-1, 0, -1}, {-1, 0, 2}, {3, 0, -1}};
        for (int round = 0; round < 30; ++round) {
            std::vector<NamedShape> kinds = convex_kinds(random);
            kinds.push_back({"straight triangle", Shape::triangle(corners[0], corners[1], corners[2]).value()});
            for (const NamedShape& first : kinds)
                for (const NamedShape& second : kinds) {
                    const RigidTransform pose_a{rotation(round), random.direction()},
                        pose_b{rotation(round), pose_a.translation + random.number(0, 1.2) * random.direction()};
                    const ShapeAtPose a{first.shape, pose_a}, b{second.shape, pose_b};
                    CAPTURE(first.name);
                    CAPTURE(second.name);
                    const Penetration p = penetration(a, b);
                    if (!p.overlapping || p.depth < 1e-4) continue;
                    ++overlaps;
                    const Motion motion{2.0 * random.direction(), double(round % 2) * random.direction(), {}};
                    const Impact i = cast(a, motion, b, {}).value();
                    CHECK(i.result == CastResult::hit);
                    CHECK(i.time == 0.0);
                    if (round % 3 != 2) CHECK(degrees_between(i.normal, p.normal) < 0.1);
                    CHECK(i.distance == doctest::Approx(-p.depth).epsilon(1e-9));
                    CHECK(glm::distance(i.on_b - i.on_a, i.distance * i.normal) < 1e-9);
                    const double off = is_hard(first.shape) || is_hard(second.shape) ? 1e-4 : 1e-8;
                    CHECK(closest_point(a, i.on_a).distance < off);
                    CHECK(closest_point(b, i.on_b).distance < off);
                    const Impact left = cast(a, motion, b, {}, {.ignore_initial_overlaps = true}).value();
                    CHECK(left.result == CastResult::miss);
                    CHECK(left.time == 1.0);
                }
        }
        CHECK(overlaps > 1000);
    }

    TEST_CASE(
        "if parts overlap from the start the deepest is the hit, and with the option the cast still hits others") {
        const Shape tile = Shape::box({0.5f, 0.5f, 0.5f}).value(), sphere = Shape::sphere(0.5).value();
        const Compound row =
            Compound::build(
                std::vector<CompoundChild>{{tile, at({0, 0, 0})}, {tile, at({0.3, 0.2, 0})}, {tile, at({5, 0, 0})}})
                .value();
        const Shape shape = Shape::compound(row);
        const RigidTransform zero, pose = at({0.3, 0.45, 0});
        const Motion right{{10, 0, 0}, {}, {}};
        const Impact i = cast({sphere, pose}, right, {shape, zero}, {}).value();
        CHECK(i.result == CastResult::hit);
        CHECK(i.time == 0.0);
        CHECK(i.part_b.child == 1);
        CHECK(i.distance == doctest::Approx(-0.75));
        CHECK(i.normal.y == doctest::Approx(-1.0));
        const Impact next = cast({sphere, pose}, right, {shape, zero}, {}, {.ignore_initial_overlaps = true}).value();
        REQUIRE(next.result == CastResult::hit);
        CHECK(next.part_b.child == 2);
        CHECK(next.on_b.x == doctest::Approx(4.5));
        CHECK(next.normal.x == doctest::Approx(1.0));
    }

    TEST_CASE("early_out changes no hit up to it and turns later ones into misses, and bad values are errors") {
        RandomShapes random(77);
        const Shape box = random.box(), sphere = Shape::sphere(0.4).value();
        const RigidTransform zero;
        for (int round = 0; round < 2000; ++round) {
            const RigidTransform from{random.rotation(), 4.0 * random.direction()};
            const Motion fly{-1.5 * from.translation + random.direction(), (round % 2) * 3.0 * random.direction(), {}};
            const Impact whole = cast({box, zero}, {}, {sphere, from}, fly).value();
            const double until = random.number(0, 1);
            const Impact early = cast({box, zero}, {}, {sphere, from}, fly, {.early_out = until}).value();
            if (whole.result == CastResult::hit && whole.time <= until) {
                CHECK(early.result == CastResult::hit);
                CHECK(early.time == whole.time);
                CHECK(early.on_a == whole.on_a);
                CHECK(early.normal == whole.normal);
            } else {
                CHECK(early.result == CastResult::miss);
                CHECK(early.time == until);
            }
        }
        CHECK_FALSE(cast({box, zero}, {}, {sphere, zero}, {}, {.early_out = -1.0}).has_value());
        CHECK_FALSE(cast({box, zero}, {}, {sphere, zero}, {}, {.early_out = NAN}).has_value());
    }

    TEST_CASE(
        "cones and cylinders are hit no farther away than the tolerance, and their distance there is known to 1e-10") {
        RandomShapes random(78);
        const Shape shapes[] = {Shape::cone(0.8f, 0.6f).value(), Shape::cylinder(0.5f, 0.8f).value(),
                                Shape::box({0.5f, 0.7f, 0.9f}).value(),
                                Shape::triangle({-1, 0, -1}, {1, 0, -1}, {0, 0, 1}).value()};
        int hits = 0;
        for (int i = 0; i < 100000; ++i) {
            const Shape &first = shapes[i % 2], &second = shapes[i / 2 % 4];
            const RigidTransform pose_a{random.rotation(), {}}, pose_b{random.rotation(), 5.0 * random.direction()};
            const Motion fly{0.8 * random.direction() - pose_b.translation, {}, {}};
            const Impact impact = cast({first, pose_a}, {}, {second, pose_b}, fly).value();
            if (impact.result != CastResult::hit) continue;
            ++hits;
            const RigidTransform then = moved(pose_b, fly, impact.time);
            const Distance d = distance({first, pose_a}, {second, then});
            CHECK(d.upper < 1e-6 + 1e-9);
            CHECK(d.upper - d.lower < 3e-10);
        }
        CHECK(hits > 80000);
    }
}
