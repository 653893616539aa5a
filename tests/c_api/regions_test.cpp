// SPDX-License-Identifier: MIT
// Regions of a world.
#include <vector>

#include "world_fixture.hpp"

using namespace crofton::capi_test;

namespace {

crofton_region_object sphere_at(double x, double y, double z, std::uint64_t user) {
    crofton_region_object object = crofton_default_region_object();
    object.bound.kind = CROFTON_BOUND_SPHERE;
    object.bound.center[0] = x;
    object.bound.center[1] = y;
    object.bound.center[2] = z;
    object.bound.radius = 0.5;
    object.user = user;
    return object;
}

RegionOwner prepare(const std::vector<crofton_region_object>& objects) {
    crofton_region* region = nullptr;
    REQUIRE(crofton_region_prepare(objects.data(), objects.size(), nullptr, nullptr, &region) == CROFTON_OK);
    return RegionOwner(region);
}

}  // namespace

TEST_SUITE("capi/regions") {
    TEST_CASE(
        "a region's objects are hit where its origin puts them, can be hidden, and are stale once it is detached") {
        WorldHandle world = make_world();
        RegionOwner region = prepare({sphere_at(0, 0, 0, 5), sphere_at(3, 0, 0, 6)});
        const double origin[3] = {1e7, 0.0, -10.0};
        crofton_attached_region attached{};
        REQUIRE(crofton_world_attach(world.get(), region.get(), origin, &attached) == CROFTON_OK);
        region.reset();  // the world keeps what it needs
        REQUIRE(crofton_world_update(world.get(), nullptr) == CROFTON_OK);
        const crofton_ray ray{{1e7 + 3.0, 0.0, 0.0}, {0.0, 0.0, -1.0}, 100.0};
        crofton_object_hit hit{};
        REQUIRE(crofton_world_raycast(world.get(), &ray, 1, nullptr, &hit) == CROFTON_OK);
        CHECK(hit.user == 6);
        CHECK(hit.t == 9.5);
        CHECK(hit.object.index >= CROFTON_FIRST_REGION_INDEX);

        crofton_attached_region found{};
        std::uint32_t place = 0;
        REQUIRE(crofton_world_place_of(world.get(), hit.object, &found, &place) == CROFTON_OK);
        CHECK(found.index == attached.index);
        CHECK(found.generation == attached.generation);
        CHECK(place == 1);
        crofton_object object{};
        REQUIRE(crofton_world_object_in(world.get(), attached, 1, &object) == CROFTON_OK);
        CHECK(object.index == hit.object.index);
        CHECK(object.generation == hit.object.generation);
        CHECK(crofton_world_object_in(world.get(), attached, 2, &object) == CROFTON_OUT_OF_RANGE);
        auto info = sized<crofton_object_info>();
        REQUIRE(crofton_world_get_object(world.get(), object, &info) == CROFTON_OK);
        CHECK(info.user == 6);
        CHECK(info.has_box == 1);
        CHECK(info.has_transform == 0);
        CHECK(info.box.center[0] == 1e7 + 3.0);

        crofton_object_description description = crofton_default_object_description();
        description.hidden = 1;
        CHECK(crofton_world_set(world.get(), object, CROFTON_SET_USER | CROFTON_SET_HIDDEN, &description) ==
              CROFTON_UNSUPPORTED);
        REQUIRE(crofton_world_set(world.get(), object, CROFTON_SET_HIDDEN, &description) == CROFTON_OK);
        CHECK(crofton_world_remove(world.get(), object) == CROFTON_UNSUPPORTED);
        REQUIRE(crofton_world_update(world.get(), nullptr) == CROFTON_OK);
        REQUIRE(crofton_world_raycast(world.get(), &ray, 1, nullptr, &hit) == CROFTON_OK);
        CHECK(hit.object.index == CROFTON_NONE);
        REQUIRE(crofton_world_detach(world.get(), attached) == CROFTON_OK);
        CHECK(crofton_world_detach(world.get(), attached) == CROFTON_STALE_HANDLE);
        CHECK(crofton_world_object_in(world.get(), attached, 0, &object) == CROFTON_STALE_HANDLE);
        CHECK(crofton_world_place_of(world.get(), object, &found, &place) == CROFTON_STALE_HANDLE);
    }

    TEST_CASE("layers, pairs and the options of preparing do what their names say") {
        WorldHandle world = make_world();
        std::vector<crofton_region_object> objects{sphere_at(0, 0, 0, 5), sphere_at(0.25, 0, 0, 6)};
        objects[0].layers = 2;
        objects[1].collides_with = 0;
        const RegionOwner region = prepare(objects);
        const double origin[3] = {0.0, 0.0, 0.0};
        crofton_attached_region attached{};
        REQUIRE(crofton_world_attach(world.get(), region.get(), origin, &attached) == CROFTON_OK);
        crofton_bound bound{};
        bound.kind = CROFTON_BOUND_SPHERE;
        bound.radius = 0.1;
        crofton_object_description description = crofton_default_object_description();
        description.bound = &bound;
        description.user = 9;
        crofton_object own{};
        REQUIRE(crofton_world_add(world.get(), &description, &own) == CROFTON_OK);
        REQUIRE(crofton_world_update(world.get(), nullptr) == CROFTON_OK);
        const crofton_object_pair* pairs = nullptr;
        std::size_t count = 0;
        REQUIRE(crofton_world_pairs(world.get(), &pairs, &count) == CROFTON_OK);
        REQUIRE(count == 1);
        CHECK(pairs[0].first.user == 9);
        CHECK(pairs[0].second.user == 5);
        const crofton_ray ray{{0.0, 0.0, 5.0}, {0.0, 0.0, -1.0}, 100.0};
        crofton_object_hit hit{};
        const crofton_query_filter filter = in_layers(2);
        REQUIRE(crofton_world_raycast(world.get(), &ray, 1, &filter, &hit) == CROFTON_OK);
        CHECK(hit.t == 4.5);

        crofton_region* none = nullptr;
        crofton_region_options options = crofton_default_region_options();
        options.max_objects = 1;
        CHECK(crofton_region_prepare(objects.data(), 2, &options, nullptr, &none) == CROFTON_OUT_OF_RANGE);
        options.max_objects = 2;
        int asked = 0;
        options.stop_user = &asked;
        options.should_stop = [](void* user, double) { return ++*static_cast<int*>(user); };
        CHECK(crofton_region_prepare(objects.data(), 2, &options, nullptr, &none) == CROFTON_CANCELLED);
        CHECK(asked == 1);
        objects[1].bound.radius = -1.0;
        CHECK(crofton_region_prepare(objects.data(), 2, nullptr, nullptr, &none) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_last_error_item() == 1);
        objects[1].bound.kind = 77;
        CHECK(crofton_region_prepare(objects.data(), 2, nullptr, nullptr, &none) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_last_error_item() == 1);
        CHECK(crofton_region_prepare(nullptr, 2, nullptr, nullptr, &none) == CROFTON_INVALID_ARGUMENT);
        CHECK(none == nullptr);
    }

    TEST_CASE("objects of a region have meshes and shapes, which may be destroyed once the region is prepared") {
        const float positions[] = {-1, -1, 0, 1, -1, 0, 0, 1, 0};
        crofton_mesh_data mesh = crofton_default_mesh_data();
        mesh.positions = positions;
        mesh.position_count = 3;
        crofton_shape_description ball = crofton_default_shape_description();
        ball.kind = CROFTON_SHAPE_SPHERE;
        ball.radius = 2.0;
        crofton_shape* shape = nullptr;
        REQUIRE(crofton_shape_create(&ball, &shape) == CROFTON_OK);
        crofton_transform place{};
        for (int k = 0; k < 3; ++k) place.linear[4 * k] = 1.0;
        place.translation[0] = 10.0;
        std::vector<crofton_region_object> objects(3, crofton_default_region_object());
        objects[0].mesh = 0;
        objects[1].shape = shape;
        objects[1].transform = &place;
        objects[2] = sphere_at(20.0, 0.0, 0.0, 0);
        objects[2].shape = shape;
        for (std::uint64_t i = 0; i < 3; ++i) objects[i].user = i + 1;
        crofton_region_options options = crofton_default_region_options();
        options.meshes = &mesh;
        options.mesh_count = 1;
        options.max_origin = 100.0;
        crofton_region* made = nullptr;
        REQUIRE(crofton_region_prepare(objects.data(), objects.size(), &options, nullptr, &made) == CROFTON_OK);
        const RegionOwner region(made);
        REQUIRE(crofton_shape_destroy(shape) == CROFTON_OK);
        WorldHandle world = make_world();
        const double origin[3] = {0.0, 0.0, -10.0}, far[3] = {101.0, 0.0, 0.0};
        crofton_attached_region attached{};
        CHECK(crofton_world_attach(world.get(), region.get(), far, &attached) == CROFTON_OUT_OF_RANGE);
        REQUIRE(crofton_world_attach(world.get(), region.get(), origin, &attached) == CROFTON_OK);
        REQUIRE(crofton_world_update(world.get(), nullptr) == CROFTON_OK);
        const auto hit_at = [&](double x, double y) {
            const crofton_ray ray{{x, y, 0.0}, {0.0, 0.0, -1.0}, 100.0};
            crofton_object_hit hit{};
            REQUIRE(crofton_world_raycast(world.get(), &ray, 1, nullptr, &hit) == CROFTON_OK);
            return hit;
        };
        CHECK(hit_at(0.0, 0.0).user == 1);
        CHECK(hit_at(0.0, 0.0).t == 10.0);
        CHECK(hit_at(0.0, 0.0).triangle == 0);
        CHECK(hit_at(0.9, 0.9).object.index == CROFTON_NONE);
        CHECK(hit_at(10.0, 0.0).user == 2);
        CHECK(hit_at(10.0, 0.0).t == 8.0);
        CHECK(hit_at(20.0, 0.0).t == 8.0);

        objects[1].shape = nullptr;
        objects[2].shape = nullptr;
        objects[1].mesh = 1;
        CHECK(crofton_region_prepare(objects.data(), objects.size(), &options, nullptr, &made) != CROFTON_OK);
        CHECK(crofton_last_error_item() == 1);
        objects[1].mesh = CROFTON_NONE;
        options.meshes = nullptr;
        CHECK(crofton_region_prepare(objects.data(), objects.size(), &options, nullptr, &made) ==
              CROFTON_INVALID_ARGUMENT);
    }
}
