// SPDX-License-Identifier: MIT
// Members of World's structs that other tests leave at their defaults: each does what its header says.
#include <array>

#include "world_fixture.hpp"

using namespace crofton::capi_test;

TEST_SUITE("capi/world members") {
    TEST_CASE("a World answers the same with any budget for its tree, and knows its nodes and meshes") {
        for (const std::uint64_t budget : {CROFTON_AUTOMATIC, std::uint64_t{1}, std::uint64_t{0}}) {
            auto options = sized<crofton_world_options>();
            options.rebuild_budget = budget;
            const WorldHandle world = make_world(&options);
            std::vector<crofton_object> objects;
            for (int i = 0; i < 200; ++i) objects.push_back(add_bound(world, sphere_bound(0, 0, -3.0 * i, 1.0)));
            update(world);
            for (int step = 1; step < 5; ++step) {
                for (int i = step; i < 200; i += 3) {
                    const crofton_bound bound = sphere_bound(0, 0, 3.0 * i, 1.0);
                    const auto at = static_cast<std::size_t>(i);
                    REQUIRE(world_set_bound(world.get(), objects[at], &bound) == CROFTON_OK);
                }
                update(world);
            }
            const Found found = make_found();
            const double center[3] = {0, 0, 150};
            REQUIRE(world_overlap_sphere(world.get(), center, 10.0, nullptr, found.get()) == CROFTON_OK);
            const crofton_object_ref* met = nullptr;
            std::size_t count = 0;
            REQUIRE(crofton_found_objects(found.get(), &met, &count) == CROFTON_OK);
            CHECK(count == 7);  // 3 i from 139 to 161, all of which have come over by now
        }
        const WorldHandle world = make_world();
        crofton_node node{};
        REQUIRE(crofton_world_add_node(world.get(), nullptr, nullptr, ~0u, &node) == CROFTON_OK);
        const crofton_world_mesh mesh = add_tetrahedron(world);
        int contains = 7;
        CHECK((crofton_world_contains_node(world.get(), node, &contains) == CROFTON_OK && contains == 1));
        REQUIRE(crofton_world_remove_mesh(world.get(), mesh) == CROFTON_OK);
        CHECK((world_contains_mesh(world.get(), mesh, &contains) == CROFTON_OK && contains == 0));
    }

    TEST_CASE("arrays that are not aligned are refused, and spheres that are no number") {
        const SmallWorld small;
        alignas(8) unsigned char bytes[sizeof(crofton_transform) + 8] = {};
        const auto* shifted = reinterpret_cast<const crofton_box*>(bytes + 4);
        CHECK(crofton_world_set_boxes(small.world.get(), &small.box, 0, shifted, 0, 1) == CROFTON_INVALID_ARGUMENT);
        CHECK(mentions(crofton_last_error(), "not aligned"));
        const double center[3] = {0, 0, -5};
        CHECK(world_overlap_sphere(small.world.get(), center, kNotANumber, nullptr, small.found.get()) ==
              CROFTON_NON_FINITE);
        CHECK(world_overlap_sphere(small.world.get(), center, -1.0, nullptr, small.found.get()) ==
              CROFTON_INVALID_ARGUMENT);
        crofton_box stored{};
        REQUIRE(world_get_box(small.world.get(), small.box, &stored) == CROFTON_OK);
        CHECK(stored.center[2] == -5);
    }

    TEST_CASE("finding occluders minds each option, and drawing them minds its own") {
        const WorldHandle world = make_world();
        const crofton_world_mesh mesh = add_tetrahedron(world);
        const auto find = [&](auto change) {
            auto options = sized<crofton_find_options>();
            change(options);
            REQUIRE(crofton_world_find_occluders(world.get(), mesh, &options) == CROFTON_OK);
            std::size_t count = 0;
            REQUIRE(world_occluder_count(world.get(), mesh, &count) == CROFTON_OK);
            return count;
        };
        using Options = crofton_find_options;
        CHECK(find([](Options&) {}) > 0);
        CHECK(find([](Options& o) { o.max_occluders = 1; }) == 1);
        CHECK(find([](Options& o) { o.max_edges = 1; }) == 0);
        CHECK(find([](Options& o) { o.least_gain = 1.0; }) <= 1);
        CHECK(find([](Options& o) { o.max_boxes_a_piece = 1, o.max_patch_triangles = 1, o.is_two_sided = 1; }) > 0);
        auto wrong = sized<Options>();
        for (const double value : {-1.0, 2.0, kNotANumber})
            for (double Options::*const member : {&Options::least_gain, &Options::flatness}) {
                wrong.least_gain = wrong.flatness = 0.0;
                wrong.*member = value;
                CHECK(crofton_world_find_occluders(world.get(), mesh, &wrong) == CROFTON_OUT_OF_RANGE);
            }

        // A patch with one side, and a box without triangles, come back as they were given.
        const Tetrahedron tetrahedron;
        std::array<crofton_occluder, 2> given{sized<crofton_occluder>(), sized<crofton_occluder>()};
        given[0].kind = CROFTON_OCCLUDER_PATCH;
        given[0].is_one_sided = 1;
        given[0].positions = tetrahedron.positions.data();
        given[0].position_count = 4;
        given[0].indices = tetrahedron.indices.data();
        given[0].index_count = 3;
        given[0].box = given[1].box = box_at(0, 0, 0);
        REQUIRE(crofton_world_set_occluders(world.get(), mesh, given.data(), 2) == CROFTON_OK);
        auto occluder = sized<crofton_occluder>();
        REQUIRE(crofton_world_get_occluder(world.get(), mesh, 0, &occluder) == CROFTON_OK);
        CHECK(occluder.is_one_sided == 1);
        REQUIRE(crofton_world_get_occluder(world.get(), mesh, 1, &occluder) == CROFTON_OK);
        CHECK(occluder.is_one_sided == 0);
        CHECK((occluder.positions == nullptr) == (occluder.position_count == 0));

        // A wall before the eye is an occluder until it must cover more of what is seen than it does.
        crofton_object object{};
        auto description = sized<crofton_object_description>();
        const crofton_transform place = translation(0, 0, -3);
        description.transform = &place;
        description.has_mesh = 1;
        description.mesh = mesh;
        REQUIRE(crofton_world_add(world.get(), &description, &object) == CROFTON_OK);
        update(world);
        const ViewResultHandle visible = make_view_result();
        crofton_camera camera = crofton_default_camera();
        crofton_view_request view = request_of(camera);
        const auto drawn = [&](std::uint32_t most, float least) {
            auto options = sized<crofton_occlusion_options>();
            options.max_occluders = most;
            options.least_cover = least;
            view.occlusion = &options;
            REQUIRE(crofton_world_view(world.get(), &view, 1, nullptr, visible.get()) == CROFTON_OK);
            auto statistics = sized<crofton_view_info>();
            REQUIRE(crofton_view_result_get_view(visible.get(), 0, &statistics) == CROFTON_OK);
            return statistics.occluders_drawn;
        };
        CHECK(drawn(0, 0.0f) >= 1);
        CHECK(drawn(1, 0.0f) == 1);
        CHECK(drawn(0, 0.9f) == 0);
    }
}
