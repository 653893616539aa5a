// SPDX-License-Identifier: MIT
// A World's shapes in C: contacts that last, overlaps, casts, and shapes that are destroyed while they are used.
#include <cmath>
#include <cstring>

#include "world_fixture.hpp"

using namespace crofton::capi_test;

namespace {

ShapeHandle crate_of(float half) {
    const float extents[3] = {half, half, half};
    crofton_shape* shape = nullptr;
    REQUIRE(shape_box(extents, &shape) == CROFTON_OK);
    return ShapeHandle(shape);
}

crofton_box slab() {
    return {{0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}, {9, 1, 9}};
}

// A crate on a slab: the slab is object 5, the crate 6.
struct Resting {
    WorldHandle world;
    crofton_object floor{}, crate{};
    Resting() {
        auto options = sized<crofton_world_options>();
        options.contact_margin = 0.02;
        world = make_world(&options);
        floor = add_bound(world, box_bound(slab()), 5);
        crate = add_bound(world, box_bound(box_at(0, 1.49, 0, 0.55f)), 6);
        // A hull, whose points the World must keep alive after the handle is gone.
        std::vector<float> corners;
        for (int i = 0; i < 8; ++i)
            for (int k = 0; k < 3; ++k) corners.push_back((k == 1 ? 1.0f : 9.0f) * ((i >> k & 1) != 0 ? 1.0f : -1.0f));
        crofton_shape* hull = nullptr;
        REQUIRE(shape_hull(corners.data(), 8, &hull) == CROFTON_OK);
        const ShapeHandle owner(hull), box = crate_of(0.5f);
        REQUIRE(world_set_shape(world.get(), floor, hull) == CROFTON_OK);
        REQUIRE(world_set_shape(world.get(), crate, box.get()) == CROFTON_OK);
    }
    const crofton_object_contact* contacts(std::size_t expected) const {
        update(world);
        const crofton_object_contact* found = nullptr;
        std::size_t count = 0;
        REQUIRE(crofton_world_contacts(world.get(), &found, &count) == CROFTON_OK);
        REQUIRE(count == expected);
        return found;
    }
};

}  // namespace

TEST_SUITE("capi/world shapes") {
    TEST_CASE("a crate on a slab: began, stayed with the caller's numbers, stayed without its shape, ended") {
        const Resting s;
        const crofton_object_contact* contact = s.contacts(1);
        CHECK(contact->first.user == 5);
        CHECK(contact->second.user == 6);
        CHECK(contact->phase == CROFTON_CONTACT_BEGAN);
        CHECK(contact->normal[1] == doctest::Approx(1.0));
        CHECK(contact->depth == doctest::Approx(0.01));
        CHECK(contact->point_count == 0);
        REQUIRE(contact->shape_point_count == 4);
        for (int i = 0; i < 4; ++i) {
            CHECK(contact->shape_points[i].normal[1] == doctest::Approx(1.0));
            CHECK(contact->shape_points[i].depth == doctest::Approx(0.01));
            contact->shape_points[i].memory[3] = 2.5f;
        }
        crofton_bound moved = box_bound(box_at(0.01, 1.491, 0, 0.55f));
        REQUIRE(world_set_bound(s.world.get(), s.crate, &moved) == CROFTON_OK);
        contact = s.contacts(1);
        CHECK(contact->phase == CROFTON_CONTACT_STAYED);
        CHECK(contact->shape_points[0].memory[3] == 2.5f);
        REQUIRE(world_set_shape(s.world.get(), s.crate, nullptr) == CROFTON_OK);
        // Without its shape the crate's box touches: the contact goes on, with points of boxes.
        contact = s.contacts(1);
        CHECK(contact->phase == CROFTON_CONTACT_STAYED);
        CHECK(contact->second.user == 6);
        CHECK(contact->shape_point_count == 0);
        CHECK(contact->point_count == 4);
        contact = s.contacts(1);
        CHECK(contact->phase == CROFTON_CONTACT_STAYED);
        CHECK(contact->point_count == 4);
        REQUIRE(crofton_world_remove(s.world.get(), s.crate) == CROFTON_OK);
        CHECK(s.contacts(1)->phase == CROFTON_CONTACT_ENDED);
    }

    TEST_CASE("a shape may be changed while contacts are read: they hold until the next update") {
        const Resting s;
        const crofton_object_contact* contact = s.contacts(1);
        const crofton_tracked_point before = contact->shape_points[0];
        const ShapeHandle small = crate_of(0.1f);
        REQUIRE(world_set_shape(s.world.get(), s.crate, small.get()) == CROFTON_OK);
        CHECK(contact->shape_point_count == 4);
        const crofton_tracked_point& after = contact->shape_points[0];
        for (int k = 0; k < 3; ++k) {
            CHECK(after.position[k] == before.position[k]);
            CHECK(after.normal[k] == before.normal[k]);
        }
        CHECK(after.depth == before.depth);
        CHECK(after.began == before.began);
        for (int k = 0; k < 4; ++k) CHECK(after.memory[k] == before.memory[k]);
        const auto same_feature = [](const crofton_feature& a, const crofton_feature& b) {
            return a.kind == b.kind && a.index == b.index;
        };
        CHECK(same_feature(after.on_a, before.on_a));
        CHECK(same_feature(after.on_b, before.on_b));
        CHECK(std::memcmp(&after.part_a, &before.part_a, sizeof before.part_a) == 0);  // without bytes between members
        CHECK(std::memcmp(&after.part_b, &before.part_b, sizeof before.part_b) == 0);
        CHECK(s.contacts(1)->phase == CROFTON_CONTACT_ENDED);
    }

    TEST_CASE("an object is added by its shape alone, which lives as long as the object, and is moved by a transform") {
        const WorldHandle world = make_world();
        auto description = sized<crofton_object_description>();
        crofton_object low{}, high{};
        CHECK(crofton_world_add(world.get(), &description, &low) == CROFTON_INVALID_ARGUMENT);
        const crofton_transform place{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 1.75, 0}};
        {
            const ShapeHandle crate = crate_of(1.0f);
            description.shape = crate.get();
            REQUIRE(crofton_world_add(world.get(), &description, &low) == CROFTON_OK);
            description.transform = &place;
            REQUIRE(crofton_world_add(world.get(), &description, &high) == CROFTON_OK);
            const crofton_bound bound = box_bound(box_at(0, 0, 0, 0.25f));
            description.bound = &bound;
            CHECK(crofton_world_add(world.get(), &description, &high) == CROFTON_INVALID_ARGUMENT);
        }
        CHECK(world_set_shape(world.get(), low, nullptr) == CROFTON_INVALID_ARGUMENT);
        for (const double height : {1.75, 1.5}) {
            const crofton_transform there{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, height, 0}};
            REQUIRE(crofton_world_set_transforms(world.get(), &high, 0, &there, 0, 1) == CROFTON_OK);
            update(world);
            const crofton_object_contact* contacts = nullptr;
            std::size_t count = 0;
            REQUIRE(crofton_world_contacts(world.get(), &contacts, &count) == CROFTON_OK);
            REQUIRE(count == 1);
            CHECK(contacts->shape_point_count == 4);
            CHECK(contacts->shape_points[0].depth == doctest::Approx(2.0 - height));
            crofton_box box{};
            REQUIRE(world_get_box(world.get(), high, &box) == CROFTON_OK);
            CHECK(box.center[1] == doctest::Approx(height));
            for (const float half : box.half_extents) CHECK(half == doctest::Approx(1.0));
        }
    }

    TEST_CASE("overlaps and casts of shapes") {
        const Resting s;
        update(s.world);
        const Found found = make_found();
        const ShapeHandle probe = crate_of(0.25f);
        const crofton_transform above = translation(0, 5, 0), beside = translation(0, 1.2, 0.8);
        const crofton_placed high{probe.get(), &above}, low{probe.get(), &beside};
        const crofton_object_ref* objects = nullptr;
        std::size_t count = 9;
        REQUIRE(world_overlap(s.world.get(), &high, nullptr, found.get()) == CROFTON_OK);
        REQUIRE(crofton_found_objects(found.get(), &objects, &count) == CROFTON_OK);
        CHECK(count == 0);
        // It meets the slab and the crate's box, but not the crate's shape.
        REQUIRE(world_overlap(s.world.get(), &low, nullptr, found.get()) == CROFTON_OK);
        REQUIRE(crofton_found_objects(found.get(), &objects, &count) == CROFTON_OK);
        REQUIRE(count == 1);
        CHECK(objects[0].user == 5);
        auto closest = sized<crofton_closest_object>();
        REQUIRE(world_closest(s.world.get(), &high, 9.0, nullptr, &closest) == CROFTON_OK);
        CHECK(closest.user == 6);
        CHECK(closest.distance == doctest::Approx(5.0 - 0.25 - 1.99));
        CHECK(closest.on_object[1] == doctest::Approx(1.99));
        REQUIRE(world_closest(s.world.get(), &high, 1.0, nullptr, &closest) == CROFTON_OK);
        CHECK(closest.object.index == CROFTON_NONE);
        const crofton_motion fall{{0, -10, 0}, {0, 0, 0}, {0, 0, 0}};
        auto hit = sized<crofton_shape_hit>();
        REQUIRE(crofton_world_cast(s.world.get(), &high, &fall, nullptr, nullptr, &hit) == CROFTON_OK);
        CHECK(hit.user == 6);
        CHECK(hit.result == CROFTON_CAST_HIT);
        CHECK(hit.time == doctest::Approx((5.0 - 0.25 - 1.99) / 10.0).epsilon(1e-5));
        CHECK(hit.normal[1] == doctest::Approx(-1.0));
        CHECK(hit.point[1] == doctest::Approx(1.99));
        CHECK(hit.distance >= 0.0);
        CHECK(hit.distance < 1e-6);
        const crofton_motion rise{{0, 10, 0}, {0, 0, 0}, {0, 0, 0}};
        REQUIRE(crofton_world_cast(s.world.get(), &high, &rise, nullptr, nullptr, &hit) == CROFTON_OK);
        CHECK(hit.object.index == CROFTON_NONE);
        CHECK(std::isinf(hit.time));
    }

    TEST_CASE("ground without end, shapes beyond their boxes, and rays at them") {
        const WorldHandle world = make_world();
        const crofton_plane plane{{0, 1, 0}, 0};
        crofton_shape *half = nullptr, *sphere = nullptr;
        REQUIRE(shape_half_space(&plane, &half) == CROFTON_OK);
        REQUIRE(shape_sphere(1.0f, &sphere) == CROFTON_OK);
        const ShapeHandle level(half), large(sphere);
        const auto point = [&](double x, double y) {
            crofton_bound bound{};
            bound.kind = CROFTON_BOUND_SPHERE;
            bound.center[0] = x;
            bound.center[1] = y;
            bound.radius = 0.125;
            return add_bound(world, bound);
        };
        const crofton_object ground = point(0, 0), resting = point(1e6, -0.75);
        REQUIRE(world_set_shape(world.get(), ground, level.get()) == CROFTON_OK);
        REQUIRE(world_set_shape(world.get(), resting, large.get()) == CROFTON_OK);
        update(world);
        const crofton_object_contact* contacts = nullptr;
        std::size_t count = 0;
        REQUIRE(crofton_world_contacts(world.get(), &contacts, &count) == CROFTON_OK);
        CHECK(count == 1);
        const crofton_ray rays[3] = {{{5, -4, 0}, {0, 2, 0}, kNoLimit},
                                     {{1e6, -4, 0}, {0, 2, 0}, kNoLimit},
                                     {{1e6, -1, 0}, {0, 2, 0}, kNoLimit}};
        crofton_object_hit hits[3] = {};
        REQUIRE(crofton_world_raycast(world.get(), rays, 3, nullptr, hits) == CROFTON_OK);
        const double expected[3] = {2.0, 1.125, 0.0};
        for (int i = 0; i < 3; ++i) {
            CHECK(hits[i].object.index == (i == 0 ? ground.index : resting.index));
            CHECK(hits[i].t == expected[i]);
            CHECK(hits[i].normal[1] == (i == 2 ? 0.0 : -1.0));
            CHECK(hits[i].started_inside == (i == 2 ? 1 : 0));
            CHECK(hits[i].child == 0);
            CHECK(hits[i].triangle == CROFTON_NONE);
        }
    }

    TEST_CASE("half-spaces to ask with, stale objects, dead shapes and bad margins are refused") {
        const Resting s;
        update(s.world);
        const crofton_plane plane{{0, 1, 0}, 0};
        crofton_shape* made = nullptr;
        REQUIRE(shape_half_space(&plane, &made) == CROFTON_OK);
        const ShapeHandle half(made);
        const crofton_transform here = translation(0, 0, 0);
        const crofton_placed placed{half.get(), &here};
        const Found found = make_found();
        auto hit = sized<crofton_shape_hit>();
        CHECK(world_overlap(s.world.get(), &placed, nullptr, found.get()) == CROFTON_UNSUPPORTED);
        CHECK(crofton_world_cast(s.world.get(), &placed, nullptr, nullptr, nullptr, &hit) == CROFTON_UNSUPPORTED);
        CHECK(crofton_world_cast_all(s.world.get(), &placed, nullptr, nullptr, nullptr, found.get()) ==
              CROFTON_UNSUPPORTED);
        CHECK(crofton_world_manifolds(s.world.get(), &placed, nullptr, nullptr, found.get()) == CROFTON_UNSUPPORTED);
        auto closest = sized<crofton_closest_object>();
        CHECK(world_closest(s.world.get(), &placed, 1.0, nullptr, &closest) == CROFTON_UNSUPPORTED);
        REQUIRE(crofton_world_remove(s.world.get(), s.crate) == CROFTON_OK);
        const ShapeHandle box = crate_of(1);
        CHECK(world_set_shape(s.world.get(), s.crate, box.get()) == CROFTON_STALE_HANDLE);
        CHECK(world_set_shape(nullptr, s.crate, box.get()) == CROFTON_BAD_HANDLE);
        auto options = sized<crofton_world_options>();
        crofton_world* none = nullptr;
        for (const double margin : {kNotANumber, kNoLimit}) {
            options.contact_margin = margin;
            CHECK(crofton_world_create(&options, &none) == CROFTON_NON_FINITE);
        }
        options.contact_margin = -1.0;
        CHECK(crofton_world_create(&options, &none) == CROFTON_INVALID_ARGUMENT);
        CHECK(none == nullptr);
    }
}
