// SPDX-License-Identifier: MIT
// Objects with shapes: contacts that last, overlaps and casts of shapes.
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/convex/query.hpp>
#include <crofton/crofton.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "../../shape/convex/surfaces.hpp"
#include "shape_pose.hpp"

using namespace crofton;
using namespace crofton::testing;

namespace {

// Around the shape's origin, where the shape stands.
Obb box_around(const convex::Shape& shape, const RigidTransform& pose) {
    const glm::dvec3 half = glm::max(glm::abs(shape.bounds().min), glm::abs(shape.bounds().max)) * 1.000001;
    return {pose.translation, glm::mat3(pose.rotation), glm::vec3(half)};
}

struct Thing {
    convex::Shape shape;
    Obb box;
    ObjectHandle object;
    bool has_shape;
};

}  // namespace

TEST_SUITE("world/shapes") {
    TEST_CASE(
        "stale handles and half-spaces to ask with are refused, and a world without shapes has no contacts of shapes") {
        World world;
        const convex::Shape box = convex::Shape::box({1, 1, 1}).value();
        const convex::Shape half = convex::Shape::half_space({{0, 1, 0}, 0}).value();
        CHECK(world.set_shape({}, &box).error().code == ErrorCode::stale_handle);
        const ObjectHandle object = world.add({.bound = Sphere{{}, 1.0}}).value();
        REQUIRE(world.set_shape(object, nullptr).has_value());
        REQUIRE(world.update().has_value());
        CHECK(world.contacts().empty());
        CHECK(error_of(world.cast(half, {}, {}, {})).code == ErrorCode::unsupported);
        CHECK(error_of(world.cast(box, {}, {{NAN, 0, 0}, {}, {}}, {})).code == ErrorCode::non_finite);
        RigidTransform bad;
        bad.translation.x = NAN;
        CHECK(error_of(world.cast(box, bad, {}, {})).code == ErrorCode::non_finite);
        Vector<ObjectRef> found(1);
        world.overlap(box, bad, found);
        CHECK(found.empty());
        CHECK(!world.closest(box, bad, 1e9));
        CHECK(!world.closest(half, {}, 1e9));
        CHECK(!world.closest(box, {}, NAN));
        // Spheres keep their radius in double, and bounds too large for a shape are cut.
        const double radius = 1.0 + 0x1p-40;
        REQUIRE(world.add({.bound = Sphere{{0, 9, 0}, radius}}).has_value());
        REQUIRE(world.add({.bound = Sphere{{5e17, 0, 0}, 4e17}}).has_value());
        REQUIRE(world.update().has_value());
        CHECK(world.closest(box, {}, 1e9)->distance == 0.0);
        RigidTransform above;
        above.translation.y = 12;
        CHECK(world.closest(box, above, 1e9)->distance == 2.0 - radius);
    }

    TEST_CASE("a cast far from the origin hits what it just reaches") {
        for (const double far : {0.0, 1e6, 1e9, 1e11}) {
            World world;
            const glm::dvec3 at(far, -far, far);
            const convex::Shape sphere = convex::Shape::sphere(1.0).value();
            const auto target = world.add({.bound = Obb{at, glm::mat3(1.0f), glm::vec3(1.0f)}}).value();
            REQUIRE(world.update().has_value());
            for (int axis = 0; axis < 3; ++axis)
                for (const double side : {-1.0, 1.0}) {
                    glm::dvec3 from(0.0), way(0.0);
                    from[axis] = 12.0 * side;
                    way[axis] = -10.5 * side;  // reaches in by 0.5
                    const auto hit =
                        world.cast(sphere, {glm::dmat3(1.0), at + from}, {way, {}, {}}, {.tolerance = 1e-3});
                    REQUIRE(hit.has_value());
                    REQUIRE(hit->has_value());
                    CHECK((*hit)->object == target);
                    CHECK((*hit)->time == doctest::Approx(10.0 / 10.5).epsilon(1e-3));
                }
        }
    }

    TEST_CASE("a crate on a floor: began, stayed with the caller's numbers, kept while asleep, ended") {
        World world({.contact_margin = 0.02});
        const convex::Shape crate = convex::Shape::box({0.5f, 0.5f, 0.5f}).value();
        const convex::Shape slab = convex::Shape::box({9, 1, 9}).value();
        const auto at_height = [](double y) { return Obb{{0, y, 0}, glm::mat3(1.0f), glm::vec3(0.55f)}; };
        const ObjectHandle floor = world.add({.bound = Obb{{}, glm::mat3(1.0f), {9, 1, 9}}}).value();
        const ObjectHandle box = world.add({.bound = at_height(1.49)}).value();
        REQUIRE(world.set_shape(floor, &slab).has_value());
        REQUIRE(world.set_shape(box, &crate).has_value());
        REQUIRE(world.update().has_value());
        REQUIRE(world.contacts().size() == 1);
        CHECK(world.contacts()[0].points.empty());
        CHECK(world.contacts()[0].normal.y == doctest::Approx(1.0));
        CHECK(world.contacts()[0].depth == doctest::Approx(0.01));
        const Contact first = world.contacts()[0];
        CHECK(first.phase == ContactPhase::began);
        REQUIRE(first.shape_points.size() == 4);
        CHECK(first.shape_points[0].normal.y == doctest::Approx(1.0));
        CHECK(first.shape_points[0].contact.depth == doctest::Approx(0.01));
        for (std::uint32_t i = 0; i < 4; ++i) first.shape_points[i].memory[1] = 7.0f + static_cast<float>(i);
        for (int frame = 0; frame < 30; ++frame) {
            if (frame < 5) REQUIRE(world.set_bound(box, at_height(1.49 + 1e-4 * frame)).has_value());
            REQUIRE(world.update().has_value());
            REQUIRE(world.contacts().size() == 1);
            const Contact now = world.contacts()[0];
            CHECK(now.phase == ContactPhase::stayed);
            REQUIRE(now.shape_points.size() == 4);
            for (std::uint32_t i = 0; i < 4; ++i) {
                CHECK(now.shape_points[i].memory[1] == 7.0f + static_cast<float>(i));
                CHECK_FALSE(now.shape_points[i].began);
            }
        }
        // Another object moves: the pair that rests is kept as it is.
        const ObjectHandle other = world.add({.bound = Sphere{{50, 0, 0}, 1.0}}).value();
        for (int frame = 0; frame < 4; ++frame) {
            REQUIRE(world.set_bound(other, Sphere{{50.0 + frame, 0, 0}, 1.0}).has_value());
            REQUIRE(world.update().has_value());
            REQUIRE(world.contacts().size() == 1);
            CHECK(world.contacts()[0].shape_points[3].memory[1] == 10.0f);
        }
        REQUIRE(world.set_bound(box, at_height(9.0)).has_value());
        REQUIRE(world.update().has_value());
        REQUIRE(world.contacts().size() == 1);
        CHECK(world.contacts()[0].phase == ContactPhase::ended);
        CHECK(world.contacts()[0].shape_points.size() == 0);
        REQUIRE(world.update().has_value());
        CHECK(world.contacts().empty());
        REQUIRE(world.set_bound(box, at_height(1.49)).has_value());
        REQUIRE(world.update().has_value());
        CHECK(world.contacts()[0].phase == ContactPhase::began);
        REQUIRE(world.remove(box).has_value());
        REQUIRE(world.update().has_value());
        REQUIRE(world.contacts().size() == 1);
        CHECK(world.contacts()[0].phase == ContactPhase::ended);
    }

    TEST_CASE("pairs that rest cost nothing: only those of what moves are computed") {
        World world;
        const convex::Shape crate = convex::Shape::box({0.5f, 0.5f, 0.5f}).value();
        const auto place = [](int i) {
            return Obb{{3.0 * (i / 2), 0.99 * (i % 2), 0}, glm::mat3(1.0f), glm::vec3(0.55f)};
        };
        std::vector<ObjectHandle> objects;
        for (int i = 0; i < 2000; ++i) {
            objects.push_back(world.add({.bound = place(i)}).value());
            REQUIRE(world.set_shape(objects.back(), &crate).has_value());
        }
        REQUIRE(world.update().has_value());
        CHECK(world.contacts().size() == 1000);
        CHECK(world.statistics().shape_pairs_computed == 1000);
        REQUIRE(world.update().has_value());
        CHECK(world.statistics().shape_pairs_computed == 0);
        for (int frame = 1; frame < 8; ++frame) {
            for (const std::size_t i : {std::size_t{7}, std::size_t{801}}) {
                Obb moved = place(static_cast<int>(i));
                moved.center.x += 0.01 * frame;
                REQUIRE(world.set_bound(objects[i], moved).has_value());
            }
            REQUIRE(world.update().has_value());
            CHECK(world.statistics().shape_pairs_computed == 2);
            CHECK(world.contacts().size() == 1000);
        }
        REQUIRE(world.update().has_value());
        CHECK(world.statistics().shape_pairs_computed == 0);
        CHECK(world.contacts().size() == 1000);
        // One that comes, one that goes, one with another shape.
        const ObjectHandle more = world.add({.bound = place(2000)}).value();
        REQUIRE(world.update().has_value());
        CHECK(world.statistics().shape_pairs_computed == 0);
        Obb above = place(1);
        above.center.y += 0.9;
        REQUIRE(world.set_bound(more, above).has_value());
        REQUIRE(world.set_shape(more, &crate).has_value());
        REQUIRE(world.update().has_value());
        // With the pair below it, whose shapes have a neighbour now: normals at a seam ask for it.
        CHECK(world.statistics().shape_pairs_computed == 2);
        CHECK(world.contacts().size() == 1001);
        REQUIRE(world.remove(more).has_value());
        REQUIRE(world.update().has_value());
        CHECK(world.statistics().shape_pairs_computed == 1);
        CHECK(world.contacts().size() == 1001);  // one has ended
        const convex::Shape small = convex::Shape::box({0.25f, 0.25f, 0.25f}).value();
        REQUIRE(world.set_shape(objects[0], &small).has_value());
        REQUIRE(world.set_user(objects[4], 7).has_value());
        REQUIRE(world.update().has_value());
        CHECK(world.statistics().shape_pairs_computed == 1);
        CHECK(world.contacts()[0].phase == ContactPhase::ended);
        REQUIRE(world.update().has_value());
        CHECK(world.contacts().size() == 999);
    }

    TEST_CASE("contacts, overlaps and casts are those of all objects one by one, while they move, come and go") {
        RandomShapes random(1);
        World world;
        std::vector<Thing> things;
        std::set<std::pair<std::uint32_t, std::uint32_t>> before, bounds_before;
        int contacts = 0, overlaps = 0, hits = 0, kept = 0;
        const auto make = [&] {
            Thing thing{any_shape(random, 0.7), {}, {}, random.index(5) != 0};
            thing.box = box_around(thing.shape, {random.rotation(), 3.0 * random.direction()});
            thing.object = world.add({.bound = thing.box}).value();
            if (thing.has_shape) REQUIRE(world.set_shape(thing.object, &thing.shape).has_value());
            things.push_back(thing);
        };
        for (int i = 0; i < 60; ++i) make();
        for (int frame = 0; frame < 40; ++frame) {
            for (int k = 0; k < 10 && frame % 4 != 3; ++k) {
                Thing& thing = things[static_cast<std::size_t>(random.index(static_cast<int>(things.size())))];
                thing.box.center += 0.2 * random.direction();
                REQUIRE(world.set_bound(thing.object, thing.box).has_value());
            }
            if (frame % 5 == 4) {
                REQUIRE(world.remove(things[0].object).has_value());
                things.erase(things.begin());
                make();
            }
            REQUIRE(world.update().has_value());
            std::map<std::pair<std::uint32_t, std::uint32_t>, double> touching;
            for (std::size_t i = 0; i < things.size(); ++i)
                for (std::size_t j = 0; j < things.size(); ++j) {
                    const Thing &a = things[i], &b = things[j];
                    if (a.object.index >= b.object.index || !a.has_shape || !b.has_shape) continue;
                    const convex::Manifold m =
                        convex::contact_manifold({a.shape, pose_of(a.box)}, {b.shape, pose_of(b.box)});
                    if (m.count > 0) touching[{a.object.index, b.object.index}] = m.depth;
                }
            std::set<std::pair<std::uint32_t, std::uint32_t>> now, bounds_now;
            for (const Contact& contact : world.contacts()) {
                const auto pair = std::pair(contact.first.object.index, contact.second.object.index);
                if (contact.phase == ContactPhase::ended) {
                    CHECK(before.count(pair) + bounds_before.count(pair) == 1);
                    continue;
                }
                if (contact.shape_points.empty()) {
                    CHECK(touching.count(pair) == 0);
                    bounds_now.insert(pair);
                    continue;
                }
                now.insert(pair);
                kept += contact.phase == ContactPhase::stayed;
                CHECK((contact.phase == ContactPhase::stayed || frame % 5 == 4 || before.count(pair) == 0));
                REQUIRE(touching.count(pair) == 1);
                double deepest = -1.0;
                for (const convex::TrackedPoint& point : contact.shape_points)
                    deepest = std::max(deepest, point.contact.depth);
                CHECK(contact.depth == deepest);
                CHECK(deepest == doctest::Approx(touching[pair]).epsilon(1e-3));
            }
            CHECK(now.size() == touching.size());
            before = now;
            bounds_before = bounds_now;
            contacts += static_cast<int>(now.size());

            const convex::Shape probe = any_shape(random);
            const RigidTransform pose{random.rotation(), random.number(2, 5) * random.direction()};
            // Around its own origin, or a pivot outside.
            const convex::Motion motion{-2.0 * pose.translation, random.index(2) * 4.0 * random.direction(),
                                        random.index(2) * 3.0 * random.direction()};
            std::vector<std::uint32_t> expected;
            double first = 1.0, least = 1e300;
            for (const Thing& thing : things) {
                const convex::Shape bound = convex::Shape::box(thing.box.half_extents).value();
                const convex::Shape& shape = thing.has_shape ? thing.shape : bound;
                const RigidTransform place = pose_of(thing.box);
                if (convex::intersects({probe, pose}, {shape, place})) expected.push_back(thing.object.index);
                least = std::min(least, convex::distance({probe, pose}, {shape, place}).distance);
                first = std::min(
                    first, convex::cast({probe, pose}, motion, {shape, place}, {}, {.max_steps = 5000}).value().time);
            }
            std::sort(expected.begin(), expected.end());
            Vector<ObjectRef> found;
            world.overlap(probe, pose, found);
            std::vector<std::uint32_t> told;
            for (const ObjectRef& ref : found) told.push_back(ref.object.index);
            CHECK(told == expected);
            overlaps += static_cast<int>(told.size());
            const auto closest = world.closest(probe, pose, 1e3);
            REQUIRE(closest.has_value());
            CHECK(closest->distance == least);
            CHECK(glm::length(closest->on_object - closest->on_shape) == doctest::Approx(least).epsilon(1e-9));
            if (least > 0.0) CHECK(!world.closest(probe, pose, 0.5 * least));
            const auto hit = world.cast(probe, pose, motion, {.max_steps = 5000}).value();
            CHECK(hit.has_value() == (first < 1.0));
            if (hit) CHECK(hit->time == doctest::Approx(first).epsilon(1e-5));
            hits += hit.has_value();
        }
        CHECK(contacts > 100);
        CHECK(kept > 100);
        CHECK(overlaps > 20);
        CHECK(hits > 20);
    }

    TEST_CASE("a shape far from its own origin reports the point at which it just touches") {
        // A step of the last place of its coordinates wide; turned, and put back near the origin.
        std::mt19937_64 random(5);
        std::uniform_real_distribution<double> angle(0.0, 3.0), power(5.0, 22.0);
        int touched = 0;
        for (int i = 0; i < 500; ++i) {
            const auto far = static_cast<float>(std::exp2(power(random)));
            const float step = std::nextafter(far, 1e30f) - far;
            std::vector<glm::vec3> points;
            for (int k = 0; k < 8; ++k)
                points.emplace_back(far + (k & 1 ? step : 0), 0.5f * far + (k & 2 ? step : 0), k & 4 ? step : 0);
            const auto hull = convex::Hull::build(points);
            if (!hull) continue;
            const auto shape = convex::Shape::hull(*hull);
            const glm::dquat turn(glm::dvec3(angle(random), 0.0, angle(random)));
            RigidTransform pose{glm::mat3_cast(turn), {}};
            pose.translation = -(pose.rotation * glm::dvec3(points[0]));
            glm::dvec3 middle(0.0), top(-1e300, 0.0, 0.0);
            for (const glm::vec3& p : points) {
                const glm::dvec3 q = pose.rotation * glm::dvec3(p) + pose.translation;
                middle += 0.125 * q;
                if (q.x > top.x) top = q;
            }
            const auto point = convex::Shape::box(glm::vec3(0.0f)).value();
            const auto meets = [&](double t) {
                return convex::intersects({shape, pose}, {point, {glm::dmat3(1.0), middle + t * (top - middle)}});
            };
            double within = 0.0, beyond = 4.0;
            if (!meets(within) || meets(beyond)) continue;
            for (int k = 0; k < 80; ++k) {
                const double t = 0.5 * (within + beyond);
                (meets(t) ? within : beyond) = t;
            }
            World world;
            REQUIRE(world.add({.bound = Obb{middle + within * (top - middle), glm::mat3(1.0f), {}}}).has_value());
            REQUIRE(world.update().has_value());
            Vector<ObjectRef> found;
            world.overlap(shape, pose, found);
            CHECK(found.size() == 1);
            ++touched;
        }
        CHECK(touched > 300);
    }

    TEST_CASE("boxes whose axes are left-handed or not quite orthonormal are no larger for shapes than they are") {
        const auto s = std::sqrt(0.5f);
        const auto sphere = convex::Shape::sphere(0.05f).value();
        for (int kind = 0; kind < 3; ++kind) {
            CAPTURE(kind);
            glm::mat3 axes(s, s, 0, -s, s, 0, 0, 0, 1);
            if (kind == 1) axes[2] = -axes[2];
            if (kind == 2) axes[0] *= 1.00002f, axes[1] += 3e-5f * axes[0];
            const Obb box{{1.0, 2.0, 3.0}, axes, {1.0f, 1.0f, 1.0f}};
            World world;
            REQUIRE(world.add({.bound = box}).has_value());
            REQUIRE(world.update().has_value());
            // Beside the edge at 45 degrees, which a box along the coordinate axes would hold.
            const RigidTransform beside{glm::dmat3(1.0), box.center + glm::dvec3(1.2, 1.2, 0.0)};
            Vector<ObjectRef> found;
            world.overlap(sphere, beside, found);
            CHECK(found.empty());
            const auto gap = collide::distance(box, collide::Capsule{beside.translation, beside.translation, 0.05});
            CHECK(world.closest(sphere, beside, 9.0)->distance == doctest::Approx(gap.distance).epsilon(2e-4));
            CHECK(world.closest(sphere, beside, 9.0)->distance <= gap.distance * (1.0 + 1e-9));
        }
    }
}
