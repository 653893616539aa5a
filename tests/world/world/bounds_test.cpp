// SPDX-License-Identifier: MIT
// Objects that are bounds alone.
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/crofton.hpp>
#include <error_of.hpp>
#include <limits>
#include <string>
#include <vector>

#include "box_at.hpp"

using namespace crofton;
using testing::box_at;

namespace {

const double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

TEST_SUITE("world/bounds") {
    TEST_CASE("an empty world answers, before and after its first update") {
        World world;
        ViewResult visible;
        Vector<ObjectHit> hits(1);
        Vector<ObjectRef> found(1);
        for (int update = 0; update < 2; ++update) {
            REQUIRE(world.view({.camera = Camera()}, visible).has_value());
            CHECK(visible.size() == 0);
            CHECK(!world.raycast({}));
            CHECK(!world.raycast_any({}));
            world.raycast_all({}, hits);
            CHECK(hits.empty());
            world.overlap(Sphere{{}, 1e3}, found);
            CHECK(found.empty());
            CHECK(!world.closest(Sphere{}, 1e9));
            CHECK(world.pairs().empty());
            CHECK(world.contacts().empty());
            REQUIRE(world.update().has_value());
        }
        CHECK(world.object_count() == 0);
        CHECK(!world.contains(ObjectHandle()));
        CHECK(error_of(world.remove(ObjectHandle())).code == ErrorCode::stale_handle);
    }

    TEST_CASE("bounds that are none are refused with a reason, and spoil nothing") {
        World world;
        const auto good = world.add({.bound = box_at({}), .user = 5}).value();
        Obb bad = box_at({});
        CHECK(error_of(world.add({})).code == ErrorCode::invalid_argument);
        for (const double number : {kNan, kInfinity, 2e30}) {
            bad.center = {0.0, number, 0.0};
            const ErrorCode code = number == 2e30 ? ErrorCode::out_of_range : ErrorCode::non_finite;
            CHECK(error_of(world.add({.bound = bad})).code == code);
            CHECK(error_of(world.set_bound(good, bad)).code == code);
            CHECK(error_of(world.set_bound(good, bad)).item == good.index);
            CHECK(error_of(world.add({.bound = Sphere{{0.0, number, 0.0}, 1.0}})).code == code);
            CHECK(error_of(world.add({.bound = Sphere{{}, number}})).code == code);
            CHECK_FALSE(world.add({.bound = Aabb{{}, glm::dvec3(number)}}).has_value());
        }
        CHECK(error_of(world.add({.bound = Sphere{{}, -1.0}})).code == ErrorCode::invalid_argument);
        CHECK_FALSE(world.add({.bound = Aabb()}).has_value());
        REQUIRE(world.update().has_value());
        CHECK(world.object_count() == 1);
        CHECK(world.box_of(good)->center == glm::dvec3(0.0));
        CHECK(!world.raycast({{kNan, 0.0, 0.0}, {1.0, 0.0, 0.0}}));
        Vector<ObjectRef> found;
        for (const double number : {kNan, kInfinity, -1.0}) {
            world.overlap(Sphere{{}, number}, found);
            CHECK(found.empty());
            CHECK(!world.closest(Sphere{{}, number}, 1.0));
            CHECK(!world.closest(Sphere{{0.0, 5.0, 0.0}, 1.0}, number == kInfinity ? kNan : number));
        }
        CHECK(world.closest(Sphere{{0.0, 5.0, 0.0}, 1.0}, kInfinity)->distance == doctest::Approx(3.5));
        for (const double tiny : {5e-324, 1e-310, 1e-300, 0.0}) {
            CHECK(!world.closest(Sphere{{0.0, 5.0, 0.0}, 1.0}, tiny));
            CHECK(world.closest(Sphere{{0.0, 1.5, 0.0}, 1.0}, tiny)->distance == 0.0);
        }
    }

    TEST_CASE("the box of a sphere holds the sphere, whose radius no float has") {
        for (int i = 0; i < 1000; ++i) {
            const double radius = 1.0 + i * 0x1p-32;  // between two floats
            const Bound bound = Sphere{{0.0, 0.0, 0.0}, radius};
            for (int k = 0; k < 3; ++k) REQUIRE(static_cast<double>(bound.box.half_extents[k]) >= radius);
        }
        World world;
        const double radius = 1.0 + 0.3 * 0x1p-23, height = 1.0 + 0.2 * 0x1p-23;
        const auto sphere = world.add({.bound = Sphere{{0.0, 0.0, 0.0}, radius}}).value();
        for (int frame = 0; frame < 3; ++frame) {  // in the tree, and among what moves
            REQUIRE(world.update().has_value());
            const auto hit = world.raycast({{-5.0, height, 0.0}, {1.0, 0.0, 0.0}});
            REQUIRE(hit.has_value());
            CHECK(hit->object == sphere);
            REQUIRE(world.set_bound(sphere, Sphere{{1e-9 * frame, 0.0, 0.0}, radius}).has_value());
        }
    }

    TEST_CASE("set_bounds refuses bad boxes and names the first, and the others move") {
        World world;
        std::vector<ObjectHandle> objects;
        for (int i = 0; i < 6; ++i) objects.push_back(world.add({.bound = box_at({3.0 * i, 0.0, 0.0})}).value());
        REQUIRE(world.update().has_value());
        REQUIRE(world.remove(objects[4]).has_value());
        std::vector<Obb> boxes;
        for (int i = 0; i < 6; ++i) boxes.push_back(box_at({3.0 * i, 7.0, 0.0}));
        boxes[2].half_extents.y = -1.0f;
        const auto moved = world.set_bounds(objects, boxes);
        REQUIRE_FALSE(moved.has_value());
        CHECK(error_of(moved).item == 2);
        CHECK(error_of(moved).code == ErrorCode::invalid_argument);
        boxes[2].half_extents.y = 1.0f;
        CHECK(error_of(world.set_bounds(objects, boxes)).item == 4);
        CHECK(error_of(world.set_bounds(objects, boxes)).code == ErrorCode::stale_handle);
        CHECK(error_of(world.set_bounds(objects, std::vector<Obb>(2))).code == ErrorCode::invalid_argument);
        REQUIRE(world.update().has_value());
        for (const int i : {0, 1, 2, 3, 5}) CHECK(world.box_of(objects[std::size_t(i)])->center.y == 7.0);
    }

    TEST_CASE("members of the caller's own structs are read in place") {
        struct Thing {
            std::string name;
            ObjectHandle handle;
            Obb box;
        };
        World world;
        std::vector<Thing> things(5);
        for (Thing& thing : things) thing.handle = world.add({.bound = box_at({})}).value();
        for (std::size_t i = 0; i < 5; ++i) things[i].box = box_at({0.0, double(i), 0.0});
        REQUIRE(
            world.set_bounds({&things[0].handle, 5, sizeof(Thing)}, {&things[0].box, 5, sizeof(Thing)}).has_value());
        REQUIRE(world.update().has_value());
        for (const Thing& thing : things) CHECK(world.box_of(thing.handle)->center == thing.box.center);
    }

    TEST_CASE("a handle is stale from the removal on, also when its index is used again") {
        World world;
        const auto first = world.add({.bound = box_at({}), .user = 1}).value();
        REQUIRE(world.update().has_value());
        REQUIRE(world.remove(first).has_value());
        CHECK(!world.raycast({{0.0, 0.0, -5.0}, {0.0, 0.0, 1.0}}));
        for (int update = 0; update < 2; ++update) {
            CHECK(!world.contains(first));
            CHECK(error_of(world.remove(first)).code == ErrorCode::stale_handle);
            CHECK(error_of(world.set_bound(first, box_at({}))).code == ErrorCode::stale_handle);
            CHECK(error_of(world.set_hidden(first, true)).code == ErrorCode::stale_handle);
            CHECK(error_of(world.set_layers(first, 1)).code == ErrorCode::stale_handle);
            CHECK(error_of(world.set_collides_with(first, 1)).code == ErrorCode::stale_handle);
            CHECK(error_of(world.set_user(first, 1)).code == ErrorCode::stale_handle);
            CHECK(error_of(world.user_of(first)).code == ErrorCode::stale_handle);
            CHECK(error_of(world.box_of(first)).code == ErrorCode::stale_handle);
            CHECK(error_of(world.remove(ObjectHandle{first.index, first.generation + 7})).code ==
                  ErrorCode::stale_handle);
            REQUIRE(world.update().has_value());
        }
        const auto second = world.add({.bound = box_at({}), .user = 2}).value();
        CHECK(second.index == first.index);
        CHECK(second != first);
        CHECK(!world.contains(first));
        CHECK(world.user_of(second).value() == 2);
        CHECK(error_of(world.box_of(second)).code == ErrorCode::empty);
    }

    TEST_CASE("an object removed before its first update was never there") {
        World world;
        const auto object = world.add({.bound = box_at({})}).value();
        REQUIRE(world.remove(object).has_value());
        REQUIRE(world.update().has_value());
        CHECK(!world.raycast({{0.0, 0.0, -5.0}, {0.0, 0.0, 1.0}}));
        CHECK(world.add({.bound = box_at({})})->index == object.index);
    }

    TEST_CASE("an object that moves repeatedly leaves the tree, and goes back when it has rested") {
        World world({.updates_to_rest = 5});
        std::vector<ObjectHandle> objects;
        for (int i = 0; i < 100; ++i) objects.push_back(world.add({.bound = box_at({3.0 * i, 0.0, 0.0})}).value());
        REQUIRE(world.update().has_value());
        CHECK(world.statistics().resting == 100);
        CHECK(world.statistics().tree_built);
        const auto move = [&](double y) {
            REQUIRE(world.set_bound(objects[0], box_at({0.0, y, 0.0})).has_value());
            REQUIRE(world.update().has_value());
        };
        move(1.0);
        CHECK(world.statistics().moving == 0);  // once is no habit
        REQUIRE(world.update().has_value());
        move(2.0);
        CHECK(world.statistics().moving == 0);
        move(3.0);
        CHECK(world.statistics().moving == 1);
        CHECK(world.statistics().resting == 99);
        for (int i = 0; i < 4; ++i) move(3.0);  // to where it is
        CHECK(world.statistics().moving == 1);
        CHECK(world.statistics().boxes_changed == 0);
        move(3.0);
        CHECK(world.statistics().moving == 0);
        CHECK(world.statistics().resting == 100);
        CHECK(world.box_of(objects[0])->center.y == 3.0);
        const auto late = world.add({.bound = box_at({0.0, 0.0, 50.0})}).value();
        REQUIRE(world.update().has_value());
        CHECK(world.statistics().moving == 1);
        CHECK(!world.statistics().tree_built);
        for (int i = 0; i < 5; ++i) REQUIRE(world.update().has_value());
        CHECK(world.statistics().moving == 0);
        CHECK(world.statistics().resting == 101);
        CHECK(world.raycast({{0.0, 0.0, 60.0}, {0.0, 0.0, -1.0}})->object == late);
    }

    TEST_CASE("objects that live for 20 updates stay in the list of what moves, those that live on come to rest") {
        World world;
        std::vector<ObjectHandle> bullets;
        for (int i = 0; i < 500; ++i) REQUIRE(world.add({.bound = Sphere{{5.0 * i, 0, 0}, 1.0}}).has_value());
        for (int i = 0; i < 20; ++i) REQUIRE(world.update().has_value());
        REQUIRE(world.statistics().resting == 500);
        const auto spawn = [&](int frame) {
            bullets.push_back(world.add({.bound = Sphere{{0.1 * frame, 3, 0}, 1.0}}).value());
            if (bullets.size() > 20) REQUIRE(world.remove(bullets[bullets.size() - 21]).has_value());
            REQUIRE(world.update().has_value());
        };
        for (int frame = 0; frame < 100; ++frame) spawn(frame);
        std::size_t most_resting = 0;
        Vector<ObjectRef> found;
        for (int frame = 100; frame < 300; ++frame) {
            spawn(frame);
            most_resting = std::max<std::size_t>(most_resting, world.statistics().resting);
            world.overlap(Sphere{{0.1 * frame, 3, 0}, 0.5}, found);
            CHECK(std::any_of(found.begin(), found.end(),
                              [&](const ObjectRef& ref) { return ref.object == bullets.back(); }));
        }
        CHECK(most_resting == 500);
        CHECK(world.statistics().moving == 20);
        for (int i = 0; i < 100; ++i) REQUIRE(world.update().has_value());
        CHECK(world.statistics().moving == 0);
        CHECK(world.statistics().resting == 520);
    }

    TEST_CASE("contacts begin, stay and end, with their normal, depth and points") {
        World world;
        const auto box = world.add({.bound = box_at({}), .user = 10}).value();
        const auto sphere = world.add({.bound = Sphere{{3.0, 0.0, 0.0}, 1.0}, .user = 20}).value();
        REQUIRE(world.update().has_value());
        CHECK(world.contacts().empty());
        REQUIRE(world.set_bound(sphere, Sphere{{1.25, 0.0, 0.0}, 1.0}).has_value());
        double far = 0.0;
        for (const ContactPhase phase : {ContactPhase::began, ContactPhase::stayed, ContactPhase::stayed}) {
            REQUIRE(world.update().has_value());
            REQUIRE(world.contacts().size() == 1);
            const Contact& contact = world.contacts()[0];
            CHECK(contact.phase == phase);
            CHECK(contact.first.object == box);
            CHECK(contact.second.object == sphere);
            CHECK(contact.first.user == 10);
            CHECK(contact.second.user == 20);
            CHECK(contact.depth == doctest::Approx(0.25));
            CHECK(contact.normal.x == doctest::Approx(1.0));
            REQUIRE(contact.points.size() == 1);
            CHECK(contact.points[0].position.x == doctest::Approx(0.375));
            if (phase == ContactPhase::stayed)  // as of an update in which something else moved, too
                REQUIRE(world.add({.bound = box_at({far += 50.0, 0.0, 0.0})}).has_value());
        }
        REQUIRE(world.remove(sphere).has_value());
        const auto third = world.add({.bound = box_at({0.0, 0.75, 0.0}), .user = 30}).value();
        REQUIRE(world.update().has_value());
        REQUIRE(world.contacts().size() == 2);
        CHECK(world.contacts()[0].phase == ContactPhase::ended);
        CHECK(world.contacts()[0].second.object == sphere);
        CHECK(world.contacts()[0].second.user == 20);
        CHECK(world.contacts()[0].points.empty());
        CHECK(world.contacts()[1].phase == ContactPhase::began);
        CHECK(world.contacts()[1].second.object == third);
        CHECK(world.contacts()[1].points.size() == 4);
        REQUIRE(world.update().has_value());
        CHECK(world.contacts().size() == 1);
        REQUIRE(world.set_hidden(box, true).has_value());
        REQUIRE(world.update().has_value());
        REQUIRE(world.contacts().size() == 1);
        CHECK(world.contacts()[0].phase == ContactPhase::ended);
    }

    TEST_CASE("an index that is used again in the same frame ends one contact and begins another") {
        World world;
        REQUIRE(world.add({.bound = box_at({})}).has_value());
        const auto old = world.add({.bound = box_at({0.5, 0.0, 0.0})}).value();
        REQUIRE(world.update().has_value());
        REQUIRE(world.remove(old).has_value());
        REQUIRE(world.update().has_value());
        const auto fresh = world.add({.bound = box_at({0.5, 0.0, 0.0})}).value();
        CHECK(fresh.index == old.index);
        REQUIRE(world.update().has_value());
        REQUIRE(world.contacts().size() == 1);
        CHECK(world.contacts()[0].phase == ContactPhase::began);
        CHECK(world.contacts()[0].second.object == fresh);
    }

    TEST_CASE("more pairs than allowed are an error, the views are right all the same, and fewer are found again") {
        World world({.max_pairs = 10});
        std::vector<ObjectHandle> objects;
        for (int i = 0; i < 10; ++i) objects.push_back(world.add({.bound = box_at({0.1 * i, 0.0, 0.0})}).value());
        CHECK(error_of(world.update()).code == ErrorCode::budget_exceeded);
        CHECK(world.pairs().empty());
        CHECK(world.contacts().empty());
        ViewResult visible;
        Camera camera;
        camera.position.z = 10.0;
        REQUIRE(world.view({.camera = camera}, visible).has_value());
        CHECK(visible.size() == 10);
        CHECK_FALSE(world.update().has_value());
        for (int i = 4; i < 10; ++i) REQUIRE(world.remove(objects[std::size_t(i)]).has_value());
        REQUIRE(world.update().has_value());
        CHECK(world.pairs().size() == 6);
    }
}
