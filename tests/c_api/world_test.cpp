// SPDX-License-Identifier: MIT
// World in C: what is refused. world_agreement_test.cpp compares answers.
#include <cstddef>
#include <cstring>
#include <vector>

#include "world_fixture.hpp"

using namespace crofton::capi_test;

TEST_SUITE("capi/world") {
    TEST_CASE("NULL is refused wherever it is not documented") {
        const SmallWorld s;
        crofton_world* const world = s.world.get();
        const crofton_bound bound = sphere_bound(0, 0, 0, 1);
        const View view = default_view();
        const crofton_transform place = translation(0, 0, 0);
        const crofton_box box = box_at(0, 0, 0);
        const crofton_ray ray{{0, 0, 0}, {0, 0, -1}, kNoLimit};
        auto closest = sized<crofton_closest_object>();
        crofton_object_hit hit{};
        crofton_object object{};
        crofton_object_ref refs[1];
        crofton_node node{};
        std::size_t count = 0;
        int flag = 0;
        const crofton_status bad = CROFTON_INVALID_ARGUMENT;
        CHECK(crofton_world_create(nullptr, nullptr) == bad);
        CHECK(crofton_world_add(world, nullptr, &object) == bad);
        CHECK(crofton_world_add_mesh(world, nullptr, nullptr) == bad);
        CHECK(crofton_world_add_node(world, nullptr, nullptr, ~0u, nullptr) == bad);
        CHECK(world_set_bound(world, s.box, nullptr) == bad);
        CHECK(crofton_world_set(world, s.box, CROFTON_SET_USER, nullptr) == bad);
        const auto description = sized<crofton_object_description>();
        for (const std::uint32_t members : {256u, ~0u, CROFTON_SET_BOUND | CROFTON_SET_SHAPE | 0u,
                                            CROFTON_SET_MESH | CROFTON_SET_OCCLUDES | 0u, CROFTON_SET_MESH | 0u})
            CHECK(crofton_world_set(world, s.box, members, &description) == bad);
        crofton_object added{};
        CHECK(crofton_world_add_many(world, nullptr, 1, &added) == bad);
        CHECK(crofton_world_add_many(world, &description, 1, nullptr) == bad);
        CHECK(crofton_world_set_boxes(world, nullptr, 0, &box, 0, 1) == bad);
        CHECK(crofton_world_set_boxes(world, &s.box, 0, nullptr, 0, 1) == bad);
        CHECK(crofton_world_set_transforms(world, nullptr, 0, &place, 0, 1) == bad);
        CHECK(crofton_world_set_node_transforms(world, &node, 0, nullptr, 0, 1) == bad);
        CHECK(crofton_world_get_statistics(world, nullptr) == bad);
        CHECK(crofton_world_get_object(world, s.box, nullptr) == bad);
        CHECK(crofton_world_get_mesh(world, {}, nullptr) == bad);
        CHECK(crofton_world_contains_node(world, {}, nullptr) == bad);
        CHECK(crofton_world_view(world, nullptr, 1, nullptr, s.visible.get()) == bad);
        CHECK(crofton_world_view(world, nullptr, 1, nullptr, s.in_views.get()) == bad);
        CHECK(crofton_view_result_ids(s.visible.get(), nullptr, &count, nullptr, nullptr) == bad);
        CHECK(crofton_view_result_ids(s.in_views.get(), nullptr, &count, nullptr, nullptr) == bad);
        CHECK(crofton_world_raycast(world, nullptr, 1, nullptr, &hit) == bad);
        CHECK(crofton_world_raycast(world, &ray, 1, nullptr, nullptr) == bad);
        CHECK(crofton_world_raycast_any(world, &ray, nullptr, nullptr) == bad);
        CHECK(crofton_world_raycast_all(world, nullptr, nullptr, s.found.get()) == bad);
        CHECK(crofton_world_overlap(world, nullptr, nullptr, s.found.get()) == bad);
        crofton_query_shape no_shape{};
        no_shape.kind = CROFTON_QUERY_SHAPE_SHAPE + 1;
        CHECK(crofton_world_overlap(world, &no_shape, nullptr, s.found.get()) == bad);
        CHECK(crofton_world_closest(world, nullptr, 1.0, nullptr, &closest) == bad);
        CHECK(crofton_world_closest(world, &no_shape, 1.0, nullptr, &closest) == bad);
        CHECK(world_closest(world, &box, 1.0, nullptr, nullptr) == bad);
        CHECK(crofton_world_pairs(world, nullptr, &count) == bad);
        CHECK(crofton_world_contacts(world, nullptr, &count) == bad);
        CHECK(crofton_found_objects(s.found.get(), nullptr, &count) == bad);
        CHECK(crofton_found_hits(s.found.get(), nullptr, &count) == bad);
        CHECK(crofton_found_shape_hits(s.found.get(), nullptr, &count) == bad);
        CHECK(crofton_found_manifolds(s.found.get(), nullptr, &count) == bad);
        CHECK(crofton_world_cast_all(world, nullptr, nullptr, nullptr, nullptr, s.found.get()) == CROFTON_BAD_HANDLE);
        CHECK(crofton_world_manifolds(world, nullptr, nullptr, nullptr, s.found.get()) == CROFTON_BAD_HANDLE);
        const crofton_object_pair* pairs = nullptr;
        const crofton_object_ref* objects = nullptr;
        const crofton_object_hit* hits = nullptr;
        CHECK(crofton_world_pairs(world, &pairs, nullptr) == bad);
        CHECK(crofton_found_objects(s.found.get(), &objects, nullptr) == bad);
        CHECK(crofton_found_hits(s.found.get(), &hits, nullptr) == bad);
        const crofton_shape_hit* shape_hits = nullptr;
        const crofton_object_manifold* manifolds = nullptr;
        CHECK(crofton_found_shape_hits(s.found.get(), &shape_hits, nullptr) == bad);
        CHECK(crofton_found_manifolds(s.found.get(), &manifolds, nullptr) == bad);
        // No handle, or one of another kind.
        CHECK(crofton_world_update(nullptr, nullptr) == CROFTON_BAD_HANDLE);
        CHECK(crofton_world_destroy(reinterpret_cast<crofton_world*>(s.found.get())) == CROFTON_BAD_HANDLE);
        CHECK(world_set_bound(nullptr, s.box, &bound) == CROFTON_BAD_HANDLE);
        CHECK(look(world, view, nullptr) == CROFTON_BAD_HANDLE);
        CHECK(world_overlap(world, &box, nullptr, nullptr) == CROFTON_BAD_HANDLE);
        CHECK(world_contains(nullptr, s.box, &flag) == CROFTON_BAD_HANDLE);
        // What was never viewed, lists no world's objects.
        CHECK(crofton_view_result_list(s.visible.get(), world, 0, refs, nullptr, 1) == bad);
        CHECK(crofton_world_set_boxes(world, nullptr, 0, nullptr, 0, 0) == CROFTON_OK);
        CHECK(crofton_world_raycast(world, nullptr, 0, nullptr, nullptr) == CROFTON_OK);
        CHECK(crofton_world_view(world, nullptr, 0, nullptr, s.in_views.get()) == CROFTON_OK);
    }

    TEST_CASE("a filter ignores its objects, and is an error if it cannot be read") {
        const WorldHandle world = make_world();
        const crofton_object near = add_bound(world, box_bound(box_at(2, 0, 0))),
                             far = add_bound(world, box_bound(box_at(9, 0, 0)));
        update(world);
        const crofton_ray ray{{-5, 0, 0}, {1, 0, 0}, kNoLimit};
        crofton_object_hit hit;
        crofton_query_filter filter = crofton_default_query_filter();
        CHECK(filter.layers == ~0u);
        const auto cast = [&] { return crofton_world_raycast(world.get(), &ray, 1, &filter, &hit); };
        REQUIRE(cast() == CROFTON_OK);
        CHECK(hit.object.index == near.index);
        filter.ignored = &near;
        filter.ignored_count = 1;
        REQUIRE(cast() == CROFTON_OK);
        CHECK(hit.object.index == far.index);
        const crofton_object both[] = {near, far};
        filter.ignored = both;
        filter.ignored_count = 2;
        int any = 1;
        REQUIRE(crofton_world_raycast_any(world.get(), &ray, &filter, &any) == CROFTON_OK);
        CHECK(any == 0);
        auto closest = sized<crofton_closest_object>();
        const double center[3] = {0, 0, 0};
        REQUIRE(world_closest_to_sphere(world.get(), center, 1, kNoLimit, &filter, &closest) == CROFTON_OK);
        CHECK(closest.object.index == CROFTON_NONE);
        filter.ignored = nullptr;
        CHECK(cast() == CROFTON_INVALID_ARGUMENT);
        filter.ignored = both;
        filter.ignored_count = SIZE_MAX;
        CHECK(cast() == CROFTON_OUT_OF_RANGE);
        filter.ignored_count = 0;
        filter.size = 3;
        CHECK(cast() == CROFTON_WRONG_SIZE);
        // A filter of a caller that knows no list ends after the layers.
        filter.size = offsetof(crofton_query_filter, ignored);
        filter.ignored_count = 2;
        REQUIRE(cast() == CROFTON_OK);
        CHECK(hit.object.index == near.index);
    }

    TEST_CASE("each option does what it says") {
        const crofton_bound bound = box_bound(box_at(0, 0, 0));
        const auto count_in = [&](const crofton_world_options& options, crofton_status expected, std::size_t& pairs,
                                  std::size_t& contacts) {
            const WorldHandle world = make_world(&options);
            for (int i = 0; i < 3; ++i) add_bound(world, bound);
            CHECK(crofton_world_update(world.get(), nullptr) == expected);
            const crofton_object_pair* list = nullptr;
            REQUIRE(crofton_world_pairs(world.get(), &list, &pairs) == CROFTON_OK);
            REQUIRE(world_contact_count(world.get(), &contacts) == CROFTON_OK);
        };
        auto options = sized<crofton_world_options>();
        std::size_t pairs = 0, contacts = 0;
        count_in(options, CROFTON_OK, pairs, contacts);
        CHECK(pairs == 3);
        CHECK(contacts == 3);
        options.contacts = 0;
        count_in(options, CROFTON_OK, pairs, contacts);
        CHECK(pairs == 3);
        CHECK(contacts == 0);
        options.max_pairs = 2;
        count_in(options, CROFTON_BUDGET_EXCEEDED, pairs, contacts);
        CHECK(pairs == 0);
        options.pairs = 0;
        count_in(options, CROFTON_OK, pairs, contacts);
        CHECK(pairs == 0);
        // After how many updates at rest a box that has moved counts as resting.
        const auto updates_to_rest = [&](std::uint32_t given) {
            options = sized<crofton_world_options>();
            options.updates_to_rest = given;
            const WorldHandle world = make_world(&options);
            const crofton_object object = add_bound(world, bound);
            auto statistics = sized<crofton_world_statistics>();
            for (int i = 0; i < 4; ++i) {
                const crofton_box box = box_at(i, 0, 0);
                REQUIRE(crofton_world_set_boxes(world.get(), &object, 0, &box, 0, 1) == CROFTON_OK);
                update(world);
            }
            int updates = 0;
            for (; updates < 100; ++updates) {
                REQUIRE(crofton_world_get_statistics(world.get(), &statistics) == CROFTON_OK);
                if (statistics.resting == 1) break;
                update(world);
            }
            return updates;
        };
        CHECK(updates_to_rest(crofton_default_world_options().updates_to_rest) == updates_to_rest(16));
        CHECK(updates_to_rest(16) - updates_to_rest(4) == 12);
    }

    TEST_CASE("every call refuses a stale handle") {
        SmallWorld s;
        crofton_world* const world = s.world.get();
        const crofton_bound bound = box_bound(box_at(0, 0, 0));
        const crofton_transform place = translation(1, 2, 3);
        const crofton_box box = box_at(0, 0, 0);
        const crofton_world_mesh mesh = add_tetrahedron(s.world);
        crofton_node node{};
        REQUIRE(crofton_world_add_node(world, nullptr, nullptr, ~0u, &node) == CROFTON_OK);
        REQUIRE(crofton_world_remove(world, s.box) == CROFTON_OK);
        REQUIRE(crofton_world_remove_node(world, node) == CROFTON_OK);
        REQUIRE(crofton_world_remove_mesh(world, mesh) == CROFTON_OK);
        update(s.world);
        const crofton_object next = add_bound(s.world, bound);
        CHECK(next.index == s.box.index);
        CHECK(world_set_user(world, next, 9) == CROFTON_OK);
        CHECK(crofton_world_remove_mesh(world, add_tetrahedron(s.world)) == CROFTON_OK);
        crofton_node next_node{};
        REQUIRE(crofton_world_add_node(world, nullptr, nullptr, ~0u, &next_node) == CROFTON_OK);
        CHECK(next_node.index == node.index);
        CHECK(crofton_world_set_node_layers(world, next_node, 1) == CROFTON_OK);
        const Tetrahedron tetrahedron;
        const crofton_mesh_data data = data_of(tetrahedron);
        const crofton_status stale = CROFTON_STALE_HANDLE;
        const crofton_object never{12345, 0}, none{CROFTON_NONE, 0};
        for (const crofton_object object : {s.box, never, none}) {
            std::uint64_t user = 0;
            crofton_box at{};
            crofton_transform transform{};
            int contains = 7;
            CHECK(crofton_world_remove(world, object) == stale);
            CHECK(crofton_world_set_transforms(world, &object, 0, &place, 0, 1) == stale);
            CHECK(crofton_world_set_boxes(world, &object, 0, &box, 0, 1) == stale);
            CHECK(crofton_last_error_item() == 0);
            CHECK(world_set_bound(world, object, &bound) == stale);
            CHECK(world_set_mesh(world, object, mesh) == stale);
            CHECK(world_set_hidden(world, object, 1) == stale);
            CHECK(world_set_layers(world, object, 1) == stale);
            CHECK(world_set_collides_with(world, object, 1) == stale);
            CHECK(world_set_user(world, object, 1) == stale);
            CHECK(world_get_user(world, object, &user) == stale);
            CHECK(world_get_box(world, object, &at) == stale);
            CHECK(world_get_transform(world, object, &transform) == stale);
            CHECK(world_contains(world, object, &contains) == CROFTON_OK);
            CHECK(contains == 0);
        }
        crofton_node below{};
        CHECK(crofton_world_remove_node(world, node) == stale);
        CHECK(crofton_world_set_parent(world, node, nullptr) == stale);
        CHECK(crofton_world_set_node_layers(world, node, 1) == stale);
        CHECK(crofton_world_set_node_transforms(world, &node, 0, &place, 0, 1) == stale);
        CHECK(crofton_world_add_node(world, &node, nullptr, ~0u, &below) == stale);
        CHECK(crofton_world_remove_mesh(world, mesh) == stale);
        CHECK(crofton_world_replace_mesh(world, mesh, &data) == stale);
        CHECK(crofton_world_set_vertices(world, mesh, &data) == stale);
        auto description = sized<crofton_object_description>();
        description.has_mesh = 1;
        description.mesh = mesh;
        crofton_object object{};
        CHECK(crofton_world_add(world, &description, &object) == stale);
    }

    TEST_CASE("a handle that was never set names nothing, also where there is a first object, node and mesh") {
        const WorldHandle world = make_world();
        const crofton_world_mesh mesh = add_tetrahedron(world);
        const crofton_object object = add_bound(world, box_bound(box_at(0, 0, 0)));
        crofton_node node{};
        REQUIRE(crofton_world_add_node(world.get(), nullptr, nullptr, ~0u, &node) == CROFTON_OK);
        REQUIRE(mesh.index == 0);
        REQUIRE(object.index == 0);
        REQUIRE(node.index == 0);
        const Tetrahedron tetrahedron;
        const crofton_mesh_data data = data_of(tetrahedron);
        const crofton_status stale = CROFTON_STALE_HANDLE;
        CHECK(crofton_world_remove(world.get(), {}) == stale);
        CHECK(mentions(crofton_last_error(), "never set"));
        CHECK(crofton_world_remove_node(world.get(), {}) == stale);
        CHECK(crofton_world_replace_mesh(world.get(), {}, &data) == stale);
        auto description = sized<crofton_object_description>();
        description.has_mesh = 1;
        crofton_object never{};
        CHECK(crofton_world_add(world.get(), &description, &never) == stale);
        int contains = 7;
        CHECK(world_contains(world.get(), {}, &contains) == CROFTON_OK);
        CHECK(contains == 0);
    }

    TEST_CASE("a handle of another world is stale, and the message says so") {
        const WorldHandle first = make_world(), second = make_world();
        const crofton_world_mesh mesh = add_tetrahedron(first);
        (void)add_tetrahedron(second);
        const crofton_object object = add_bound(first, box_bound(box_at(0, 0, 0)));
        const crofton_object own = add_bound(second, box_bound(box_at(0, 0, 0)));
        REQUIRE(object.index == own.index);
        CHECK(crofton_world_remove(second.get(), object) == CROFTON_STALE_HANDLE);
        CHECK(mentions(crofton_last_error(), "another World"));
        CHECK(world_set_hidden(second.get(), object, 1) == CROFTON_STALE_HANDLE);
        CHECK(crofton_world_remove_mesh(second.get(), mesh) == CROFTON_STALE_HANDLE);
        int contains = 7;
        CHECK(world_contains(second.get(), object, &contains) == CROFTON_OK);
        CHECK(contains == 0);
        CHECK(crofton_world_remove(second.get(), own) == CROFTON_OK);
        CHECK(crofton_world_remove(first.get(), object) == CROFTON_OK);
    }

    TEST_CASE("numbers that are none are refused, and spoil nothing") {
        const SmallWorld s;
        crofton_world* const world = s.world.get();
        crofton_object object{77, 77};
        for (const double number : {kNotANumber, kNoLimit}) {
            const crofton_box box = box_at(0, number, 0);
            crofton_transform place = translation(0, 0, number);
            crofton_node node{};
            CHECK(try_add(s.world, box_bound(box), object) == CROFTON_NON_FINITE);
            CHECK(try_add(s.world, sphere_bound(0, 0, 0, number), object) == CROFTON_NON_FINITE);
            CHECK(crofton_world_set_boxes(world, &s.box, 0, &box, 0, 1) == CROFTON_NON_FINITE);
            CHECK(crofton_world_add_node(world, nullptr, &place, ~0u, &node) == CROFTON_NON_FINITE);
            crofton_bound aligned{};
            aligned.kind = CROFTON_BOUND_ALIGNED_BOX;
            aligned.max[1] = number;
            CHECK(try_add(s.world, aligned, object) != CROFTON_OK);
            const crofton_ray rays[2] = {{{0, 0, 0}, {0, 0, -1}, 1}, {{0, 0, 0}, {0, number, 0}, 1}};
            crofton_object_hit hits[2] = {};
            CHECK(crofton_world_raycast(world, rays, 2, nullptr, hits) == CROFTON_NON_FINITE);
            CHECK(crofton_last_error_item() == 1);
            CHECK(crofton_world_raycast_all(world, &rays[1], nullptr, s.found.get()) == CROFTON_NON_FINITE);
            CHECK(world_overlap(world, &box, nullptr, s.found.get()) == CROFTON_NON_FINITE);
            CHECK(world_overlap_sphere(world, box.center, 1, nullptr, s.found.get()) == CROFTON_NON_FINITE);
            CHECK(world_overlap_capsule(world, place.linear, box.center, 1, nullptr, s.found.get()) ==
                  CROFTON_NON_FINITE);
            crofton_camera camera = crofton_default_camera();
            camera.position[0] = number;
            CHECK(look(world, camera, s.visible.get()) != CROFTON_OK);
        }
        const double center[3] = {};
        auto closest = sized<crofton_closest_object>();
        CHECK(world_closest_to_sphere(world, center, 1, kNotANumber, nullptr, &closest) == CROFTON_NON_FINITE);
        CHECK(world_closest_to_sphere(world, center, 1, -1, nullptr, &closest) == CROFTON_INVALID_ARGUMENT);
        CHECK(world_closest_to_sphere(world, center, -1, 1, nullptr, &closest) == CROFTON_INVALID_ARGUMENT);
        CHECK(world_closest_to_sphere(world, center, 1, kNoLimit, nullptr, &closest) == CROFTON_OK);
        CHECK(closest.distance == doctest::Approx(3.5));  // the box's face is at z = −4.5
        CHECK(object.index == 77);
        std::size_t count = 0;
        CHECK(world_object_count(world, &count) == CROFTON_OK);
        CHECK(count == 1);
    }

    TEST_CASE("arrays, strides and kinds that cannot be are refused") {
        const SmallWorld s;
        crofton_world* const world = s.world.get();
        const crofton_box box = box_at(0, 0, 0);
        CHECK(crofton_world_set_boxes(world, &s.box, 4, &box, 0, 1) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_world_set_boxes(world, &s.box, 0, &box, sizeof box + 1, 1) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_world_set_boxes(world, &s.box, 0, &box, 0, SIZE_MAX / 8) == CROFTON_OUT_OF_RANGE);
        CHECK(crofton_world_set_boxes(world, &s.box, SIZE_MAX - 7, &box, 0, 2) == CROFTON_OUT_OF_RANGE);
        // The stride of a single element may be as large as any array.
        constexpr std::size_t kLargest = static_cast<std::size_t>(PTRDIFF_MAX) - 7;
        CHECK(crofton_world_set_boxes(world, &s.box, kLargest, &box, kLargest, 1) == CROFTON_OK);
        CHECK(crofton_world_set_boxes(world, &s.box, kLargest + 8, &box, 0, 1) == CROFTON_OUT_OF_RANGE);
        crofton_bound bound = box_bound(box);
        bound.kind = 9;
        crofton_object object{};
        CHECK(try_add(s.world, bound, object) == CROFTON_INVALID_ARGUMENT);
        bound.kind = CROFTON_BOUND_NONE;
        CHECK(try_add(s.world, bound, object) == CROFTON_INVALID_ARGUMENT);
        const Tetrahedron tetrahedron;
        crofton_mesh_data data = data_of(tetrahedron);
        crofton_world_mesh mesh{};
        data.position_stride = 8;
        CHECK(crofton_world_add_mesh(world, &data, &mesh) == CROFTON_INVALID_ARGUMENT);
        data = data_of(tetrahedron);
        data.index_count = SIZE_MAX;
        CHECK(crofton_world_add_mesh(world, &data, &mesh) == CROFTON_OUT_OF_RANGE);
        data = data_of(tetrahedron);
        data.indices = reinterpret_cast<const char*>(tetrahedron.indices.data()) + 1;
        data.index_count = 3;
        CHECK(crofton_world_add_mesh(world, &data, &mesh) == CROFTON_INVALID_ARGUMENT);
        const std::vector<View> views(33, default_view());
        CHECK(look_at_many(world, views, s.in_views.get()) == CROFTON_OUT_OF_RANGE);
        crofton_object_contact contact{};
        CHECK(world_contact(world, 0, &contact) == CROFTON_OUT_OF_RANGE);
    }

    TEST_CASE("found lists what the last query into it has found, and nothing of the one before") {
        const SmallWorld s;
        const crofton_ray ray{{0, 0, 0}, {0, 0, -1}, kNoLimit};
        const crofton_box box = box_at(0, 0, -5);
        const crofton_object_ref* objects = nullptr;
        const crofton_object_hit* hits = nullptr;
        std::size_t object_count = 0, hit_count = 0;
        const auto count = [&] {
            REQUIRE(crofton_found_objects(s.found.get(), &objects, &object_count) == CROFTON_OK);
            REQUIRE(crofton_found_hits(s.found.get(), &hits, &hit_count) == CROFTON_OK);
        };
        for (int i = 0; i < 2; ++i) {
            REQUIRE(crofton_world_raycast_all(s.world.get(), &ray, nullptr, s.found.get()) == CROFTON_OK);
            count();
            CHECK(object_count == 0);
            REQUIRE(hit_count == 1);
            CHECK(hits[0].t == doctest::Approx(4.5));
            REQUIRE(world_overlap(s.world.get(), &box, nullptr, s.found.get()) == CROFTON_OK);
            count();
            CHECK(hit_count == 0);
            REQUIRE(object_count == 1);
            CHECK(objects[0].user == 7);
        }
    }

    TEST_CASE("a result lists the objects of the world that was viewed, until its next update, and of no other") {
        SmallWorld s;
        const View view = default_view();
        crofton_object_ref refs[2] = {};
        REQUIRE(look(s.world.get(), view, s.visible.get()) == CROFTON_OK);
        REQUIRE(look_at_many(s.world.get(), std::span(&view, 1), s.in_views.get()) == CROFTON_OK);
        REQUIRE(crofton_view_result_list(s.visible.get(), s.world.get(), 0, refs, nullptr, 2) == CROFTON_OK);
        CHECK(refs[0].user == 7);
        CHECK(refs[1].user == 0);
        CHECK(crofton_view_result_list(s.visible.get(), s.world.get(), 1, refs, nullptr, 2) == CROFTON_OK);
        CHECK(crofton_view_result_list(s.visible.get(), s.world.get(), 2, refs, nullptr, 2) == CROFTON_OUT_OF_RANGE);
        // An index may be another object's after an update.
        REQUIRE(crofton_world_remove(s.world.get(), s.box) == CROFTON_OK);
        update(s.world);
        CHECK(add_bound(s.world, box_bound(box_at(0, 0, 50)), 8).index == s.box.index);
        CHECK(crofton_view_result_list(s.visible.get(), s.world.get(), 0, refs, nullptr, 2) ==
              CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_view_result_list(s.in_views.get(), s.world.get(), 0, refs, nullptr, 2) ==
              CROFTON_INVALID_ARGUMENT);
        CHECK(refs[0].user == 7);
        s.world = make_world();  // perhaps where the other one was
        CHECK(crofton_view_result_list(s.visible.get(), s.world.get(), 0, refs, nullptr, 2) ==
              CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_view_result_list(s.in_views.get(), s.world.get(), 0, refs, nullptr, 2) ==
              CROFTON_INVALID_ARGUMENT);
    }

    TEST_CASE("of many objects the valid ones are added, and the first invalid one is named") {
        const WorldHandle world = make_world();
        REQUIRE(crofton_world_reserve(world.get(), 100) == CROFTON_OK);
        CHECK(crofton_world_reserve(world.get(), (std::size_t{1} << 30) + 1) == CROFTON_OUT_OF_RANGE);
        const crofton_bound good = box_bound(box_at(1, 2, 3));
        crofton_bound bad = good;
        bad.box.center[1] = kNotANumber;
        std::vector<crofton_object_description> descriptions(5, sized<crofton_object_description>());
        for (std::size_t i = 0; i < 5; ++i) {
            descriptions[i].bound = i % 2 == 1 ? &bad : &good;
            descriptions[i].user = 10 + i;
            descriptions[i].hidden = i == 4 ? 1 : 0;
        }
        crofton_object objects[5];
        std::memset(objects, 0xff, sizeof objects);
        CHECK(crofton_world_add_many(world.get(), descriptions.data(), 5, objects) == CROFTON_NON_FINITE);
        CHECK(crofton_last_error_item() == 1);
        update(world);
        for (std::size_t i = 0; i < 5; ++i) {
            auto info = sized<crofton_object_info>();
            const bool is_there = crofton_world_get_object(world.get(), objects[i], &info) == CROFTON_OK;
            CHECK(is_there == (i % 2 == 0));
            if (is_there)
                CHECK(info.user == 10 + i);
            else
                CHECK((objects[i].index == 0 && objects[i].generation == 0));
        }
        CHECK(crofton_world_add_many(world.get(), nullptr, 0, nullptr) == CROFTON_OK);
        descriptions[1].size = offsetof(crofton_object_description, shape);
        descriptions[1].bound = &good;
        CHECK(crofton_world_add_many(world.get(), descriptions.data(), 2, objects) == CROFTON_WRONG_SIZE);
        CHECK(crofton_last_error_item() == 1);
    }
}
