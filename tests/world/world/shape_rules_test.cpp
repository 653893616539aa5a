// SPDX-License-Identifier: MIT
// Which shapes ask which: layers; front sides of surfaces; inner edges of floors.
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <crofton/crofton.hpp>
#include <limits>
#include <set>
#include <vector>

#include "../../shape/convex/surfaces.hpp"
#include "shape_pose.hpp"

using namespace crofton;
using namespace crofton::testing;

namespace {

struct Filtered {
    convex::Shape shape;
    Obb box;
    ObjectHandle object;
    std::uint32_t layers = 0, collides_with = 0;
};

using IndexPair = std::pair<std::uint32_t, std::uint32_t>;

// Many shapes in one place, each in some of four layers.
class FilteredShapes {
  public:
    explicit FilteredShapes(std::uint64_t seed) : random(seed) {
        for (int i = 0; i < 40; ++i) {
            Filtered made{any_shape(random, 0.8), {}, {}, mask(), mask()};
            made.box = {1.2 * random.direction(), glm::mat3(random.rotation()), glm::vec3(2.0f)};
            ObjectDescription description{.bound = made.box};
            description.layers = made.layers;
            description.collides_with = made.collides_with;
            made.object = world.add(description).value();
            REQUIRE(world.set_shape(made.object, &made.shape).has_value());
            things.push_back(made);
        }
    }
    std::uint32_t mask() { return static_cast<std::uint32_t>(random.index(16)); }
    void change_some() {
        for (int k = 0; k < 6; ++k) {
            Filtered& thing = things[static_cast<std::size_t>(random.index(40))];
            if (random.index(2) != 0) {
                thing.layers = mask();
                REQUIRE(world.set_layers(thing.object, thing.layers).has_value());
            } else {
                thing.collides_with = mask();
                REQUIRE(world.set_collides_with(thing.object, thing.collides_with).has_value());
            }
        }
    }
    // Pairs that touch and whose filters agree; counts in `refused` those whose filters do not.
    [[nodiscard]] std::set<IndexPair> touching(int& refused) const {
        std::set<IndexPair> pairs;
        for (const Filtered& a : things)
            for (const Filtered& b : things) {
                if (a.object.index >= b.object.index) continue;
                const RigidTransform at_a = pose_of(a.box), at_b = pose_of(b.box);
                if (convex::contact_manifold({a.shape, at_a}, {b.shape, at_b}).count == 0) continue;
                if ((a.layers & b.collides_with) != 0 && (b.layers & a.collides_with) != 0)
                    pairs.insert({a.object.index, b.object.index});
                else
                    ++refused;
            }
        return pairs;
    }

    RandomShapes random;
    World world;
    std::vector<Filtered> things;
};

// A floor of many triangles, and something on it that a step moves: it falls, contacts stop it.
class Slide {
  public:
    Slide(const convex::Shape& floor, const Obb& bound, const convex::Shape& shape)
        : floor_(floor), shape_(shape), normal_(glm::normalize(glm::dvec3(bound.axes[1]))) {
        const ObjectHandle base = world_.add({.bound = bound}).value();
        REQUIRE(world_.set_shape(base, &floor_).has_value());
        const float c = std::cos(0.7f), d = std::sin(0.7f);
        box_.axes = bound.axes * glm::mat3(c, 0, -d, 0, 1, 0, d, 0, c);
        box_.half_extents = glm::vec3(2.0f);
        box_.center = bound.center + 0.499 * normal_;
        object_ = world_.add({.bound = box_}).value();
        REQUIRE(world_.set_shape(object_, &shape_).has_value());
    }
    // How far the shape has come; it starts without friction along `velocity` within the floor's plane.
    glm::dvec3 run(glm::dvec3 velocity, int steps) {
        const glm::dvec3 start = box_.center;
        for (int step = 0; step < steps; ++step) {
            REQUIRE(world_.update().has_value());
            velocity -= 0.16 * normal_;
            double depth = 0.0;
            for (const Contact& contact : world_.contacts()) {
                CHECK((contact.phase == ContactPhase::stayed || step == 0));
                CHECK(!contact.shape_points.empty());
                for (const convex::TrackedPoint& point : contact.shape_points) {
                    const glm::dvec3& n = point.normal;
                    CHECK(glm::dot(n, normal_) > 1.0 - 1e-9);
                    velocity -= std::min(glm::dot(velocity, n), 0.0) * n;
                    depth = std::max(depth, point.contact.depth);
                }
            }
            box_.center += velocity / 60.0 + std::max(0.0, depth - 0.001) * normal_;
            REQUIRE(world_.set_bound(object_, box_).has_value());
        }
        return box_.center - start;
    }

  private:
    World world_ = World({.contact_margin = 0.02});
    convex::Shape floor_, shape_;
    glm::dvec3 normal_;
    Obb box_;
    ObjectHandle object_;
};

}  // namespace

TEST_SUITE("world/shape_rules") {
    TEST_CASE("shapes touch where each one's layers meet what the other collides with, also when these change") {
        FilteredShapes shapes(1);
        std::set<IndexPair> before;
        int refused = 0, touched = 0, ended = 0;
        for (int step = 0; step < 30; ++step) {
            if (step > 0) shapes.change_some();
            REQUIRE(shapes.world.update().has_value());
            const std::set<IndexPair> expected = shapes.touching(refused);
            std::set<IndexPair> now;
            for (const Contact& contact : shapes.world.contacts()) {
                const IndexPair pair{contact.first.object.index, contact.second.object.index};
                if (contact.phase == ContactPhase::ended) {
                    CHECK(before.count(pair) == 1);
                    ++ended;
                } else {
                    now.insert(pair);
                    CHECK((contact.phase == ContactPhase::stayed) == (before.count(pair) == 1));
                }
            }
            CHECK(now == expected);
            touched += static_cast<int>(now.size());
            before = now;
        }
        CHECK(touched > 300);
        CHECK(refused > 300);
        CHECK(ended > 30);
    }

    TEST_CASE("overlaps, casts and nearest objects of shapes use the query's layers, whatever these collide with") {
        FilteredShapes shapes(2);
        int found_all = 0, left_out = 0, hits = 0;
        for (int step = 0; step < 300; ++step) {
            if (step > 0) shapes.change_some();
            REQUIRE(shapes.world.update().has_value());
            const std::uint32_t layers = shapes.mask();
            const convex::Shape probe = any_shape(shapes.random);
            const RigidTransform pose{shapes.random.rotation(), 2.5 * shapes.random.direction()};
            const convex::Motion motion{-2.0 * pose.translation, {}, {}};
            std::vector<std::uint32_t> expected;
            double first = 2.0, least = std::numeric_limits<double>::infinity();
            for (const Filtered& thing : shapes.things) {
                const RigidTransform stand = pose_of(thing.box);
                const bool meets = convex::intersects({probe, pose}, {thing.shape, stand});
                if ((thing.layers & layers) == 0) {
                    left_out += meets;
                    continue;
                }
                if (meets) expected.push_back(thing.object.index);
                least = std::min(least, convex::distance({probe, pose}, {thing.shape, stand}).distance);
                const auto impact = convex::cast({probe, pose}, motion, {thing.shape, stand}, {}).value();
                if (impact.result != convex::CastResult::miss) first = std::min(first, impact.time);
            }
            Vector<ObjectRef> found;
            shapes.world.overlap(probe, pose, found, {layers});
            std::vector<std::uint32_t> told;
            for (const ObjectRef& ref : found) told.push_back(ref.object.index);
            CHECK(told == expected);
            found_all += static_cast<int>(told.size());
            const auto hit = shapes.world.cast(probe, pose, motion, {}, {layers}).value();
            REQUIRE(hit.has_value() == (first <= 1.0));
            if (hit) CHECK(hit->time == doctest::Approx(first).epsilon(1e-5));
            hits += hit.has_value();
            const auto nearest = shapes.world.closest(probe, pose, 1e3, {layers});
            REQUIRE(nearest.has_value() == std::isfinite(least));
            if (nearest) CHECK(nearest->distance == least);
        }
        CHECK(found_all > 60);
        CHECK(left_out > 50);
        CHECK(hits > 20);
    }

    TEST_CASE("a floor's front pushes up what has sunk in, lets pass what comes from below, both sides push back") {
        RandomShapes random(3);
        const Surface s = ground(random, 16, 0.5, [](double, double) { return 0.0; });
        const std::vector<float> level(17 * 17, 0.0f);
        const convex::HeightField field =
            convex::HeightField::build({.columns = 17, .rows = 17, .heights = level, .spacing = glm::dvec2(0.5)})
                .value();
        const convex::Shape sphere = convex::Shape::sphere(0.5f).value();
        for (const glm::dvec3& place : {glm::dvec3(0.0), glm::dvec3(1e6, -2e5, 3e6)})
            for (const convex::Sides sides : {convex::Sides::front, convex::Sides::both})
                for (const bool is_mesh : {true, false}) {
                    World world;
                    const convex::Shape floor = is_mesh ? s.shape(sides) : convex::Shape::height_field(field, sides);
                    const ObjectHandle base =
                        world.add({.bound = Obb{place, glm::mat3(1.0f), glm::vec3(9.0f)}}).value();
                    REQUIRE(world.set_shape(base, &floor).has_value());
                    // A field's corner is its origin, a mesh's middle.
                    const glm::dvec3 above = place + (is_mesh ? glm::dvec3(0.1, 0, 0.2) : glm::dvec3(4.1, 0, 4.2));
                    const auto crate = [&](double y) {
                        return Obb{above + glm::dvec3(0, y, 0), glm::mat3(1.0f), glm::vec3(0.6f)};
                    };
                    const ObjectHandle object = world.add({.bound = crate(0.1)}).value();
                    REQUIRE(world.set_shape(object, &sphere).has_value());
                    REQUIRE(world.update().has_value());
                    REQUIRE(world.contacts().size() == 1);
                    CHECK(world.contacts()[0].shape_points[0].normal.y == doctest::Approx(1.0));
                    CHECK(world.contacts()[0].shape_points[0].contact.depth == doctest::Approx(0.4));
                    REQUIRE(world.set_bound(object, crate(-0.4)).has_value());
                    REQUIRE(world.update().has_value());
                    REQUIRE(world.contacts().size() == 1);
                    const Contact below = world.contacts()[0];
                    CHECK((below.phase == ContactPhase::ended) == (sides == convex::Sides::front));
                    if (!below.shape_points.empty()) CHECK(below.shape_points[0].normal.y == doctest::Approx(-1.0));
                    // Casts, past the crate's side.
                    const glm::dvec3 aside = above + glm::dvec3(2, 0, 2);
                    const auto hit = [&](double from, double to) {
                        const RigidTransform pose{glm::dmat3(1.0), aside + glm::dvec3(0, from, 0)};
                        return world.cast(sphere, pose, {{0, to - from, 0}, {}, {}}, {}).value();
                    };
                    const auto down = hit(3, -3), up = hit(-3, 3);
                    REQUIRE(down.has_value());
                    CHECK(down->object == base);
                    CHECK(down->time == doctest::Approx(2.5 / 6).epsilon(1e-5));
                    CHECK(up.has_value() == (sides == convex::Sides::both));
                    // Yes or no is of the surface, whichever side.
                    Vector<ObjectRef> found;
                    world.overlap(sphere, {glm::dmat3(1.0), aside - glm::dvec3(0, 0.4, 0)}, found);
                    CHECK(found.size() == 1);
                }
    }

    TEST_CASE("a shape that slides over a floor of triangles keeps its speed: it meets no inner edge") {
        RandomShapes random(4);
        const Surface s = ground(random, 40, 0.5, [](double, double) { return 0.0; });
        const convex::Shape shapes[] = {
            convex::Shape::box({0.5f, 0.5f, 0.5f}).value(),
            convex::Shape::box({0.05f, 0.5f, 0.05f}).value(),
            convex::Shape::sphere(0.5f).value(),
            convex::Shape::capsule(0.2f, 0.3f).value(),
            convex::Shape::cylinder(0.5f, 0.4f).value(),
            convex::Shape::rounded(convex::Shape::box({0.3f, 0.4f, 0.3f}).value(), 0.1f).value()};
        for (const convex::Shape& shape : shapes)
            for (const convex::Sides sides : {convex::Sides::front, convex::Sides::both})
                for (const double offset : {0.0, 1e6}) {
                    // Level, and on a slope that has no axis of the world.
                    const glm::mat3 axes(offset == 0.0 ? glm::dmat3(1.0) : random.rotation());
                    const Obb bound{offset * glm::dvec3(1.0, 0.5, -0.3), axes, {11, 1, 11}};
                    const glm::dvec3 x(axes[0]), z(axes[2]);
                    const double angle = random.number(0, 6.2), speed = 3.0;
                    const glm::dvec3 velocity = speed * (std::cos(angle) * x + std::sin(angle) * z);
                    const glm::dvec3 way = Slide(s.shape(sides), bound, shape).run(velocity, 100);
                    CHECK(glm::length(way - velocity * (100 / 60.0)) < 0.01);
                }
    }
}
