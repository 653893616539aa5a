// SPDX-License-Identifier: MIT
// World in C: structs of older headers, and of newer ones.
#include <cstddef>
#include <cstring>

#include "world_fixture.hpp"

using namespace crofton::capi_test;

TEST_SUITE("capi/world structs") {
    TEST_CASE("a struct whose size is larger, none, or within the alignment is refused") {
        const SmallWorld s;
        const Tetrahedron tetrahedron;
        for (const std::size_t size : {std::size_t{0}, std::size_t{4}, std::size_t{9}, std::size_t{4096}, SIZE_MAX}) {
            CAPTURE(size);
            auto options = sized<crofton_world_options>();
            auto statistics = sized<crofton_world_statistics>();
            auto description = sized<crofton_object_description>();
            auto closest = sized<crofton_closest_object>();
            auto info = sized<crofton_object_info>();
            auto view = sized<crofton_view_info>();
            crofton_mesh_data data = data_of(tetrahedron);
            options.size = statistics.size = description.size = closest.size = info.size = data.size = size;
            view.size = size;
            crofton_world* none = nullptr;
            crofton_object object{};
            crofton_world_mesh mesh{};
            const double center[3] = {};
            CHECK(crofton_world_create(&options, &none) == CROFTON_WRONG_SIZE);
            CHECK(none == nullptr);
            CHECK(crofton_world_get_statistics(s.world.get(), &statistics) == CROFTON_WRONG_SIZE);
            CHECK(crofton_world_add(s.world.get(), &description, &object) == CROFTON_WRONG_SIZE);
            CHECK(crofton_world_add_mesh(s.world.get(), &data, &mesh) == CROFTON_WRONG_SIZE);
            CHECK(world_closest_to_sphere(s.world.get(), center, 1, 1, nullptr, &closest) == CROFTON_WRONG_SIZE);
            CHECK(crofton_world_get_object(s.world.get(), s.box, &info) == CROFTON_WRONG_SIZE);
            CHECK(crofton_world_set(s.world.get(), s.box, CROFTON_SET_USER, &description) == CROFTON_WRONG_SIZE);
            CHECK(crofton_view_result_get_view(s.visible.get(), 0, &view) == CROFTON_WRONG_SIZE);
        }
    }

    TEST_CASE("a struct with one member more than this library knows is refused") {
        const SmallWorld s;
        struct NewerOptions {
            crofton_world_options options{};
            std::uint64_t unknown = 0;
        } options;
        struct NewerStatistics {
            crofton_world_statistics statistics{};
            std::uint64_t unknown = 5;
        } statistics;
        options.options.size = sizeof options;
        statistics.statistics.size = sizeof statistics;
        crofton_world* none = nullptr;
        CHECK(crofton_world_create(&options.options, &none) == CROFTON_WRONG_SIZE);
        CHECK(crofton_world_get_statistics(s.world.get(), &statistics.statistics) == CROFTON_WRONG_SIZE);
        CHECK(statistics.statistics.objects == 0);
        CHECK(statistics.unknown == 5);
    }

    TEST_CASE("an older, smaller struct is read and written as far as it goes") {
        // Options that ended before `max_pairs`: the byte pattern behind them is not theirs.
        crofton_world_options options;
        std::memset(static_cast<void*>(&options), 0x01, sizeof options);
        options.size = offsetof(crofton_world_options, max_pairs);
        options.pairs = options.contacts = options.containment = 1;
        const WorldHandle world = make_world(&options);
        // A description that ended before `layers`.
        const crofton_bound bound = box_bound(box_at(0, 0, -5));
        crofton_object_description description;
        std::memset(static_cast<void*>(&description), 0xff, sizeof description);
        description.size = offsetof(crofton_object_description, layers);
        description.user = 3;
        description.bound = &bound;
        description.transform = nullptr;
        description.has_mesh = description.has_node = 0;
        crofton_object objects[2] = {};
        for (crofton_object& object : objects)
            REQUIRE(crofton_world_add(world.get(), &description, &object) == CROFTON_OK);
        update(world);
        const crofton_object_pair* pairs = nullptr;
        std::size_t count = 0;
        REQUIRE(crofton_world_pairs(world.get(), &pairs, &count) == CROFTON_OK);
        CHECK(count == 1);  // in all layers, and 2^24 pairs may be found
        // Results that ended before `resting` and before `transform`.
        crofton_world_statistics statistics;
        std::memset(static_cast<void*>(&statistics), 0x5a, sizeof statistics);
        const crofton_world_statistics before = statistics;
        statistics.size = offsetof(crofton_world_statistics, resting);
        REQUIRE(crofton_world_get_statistics(world.get(), &statistics) == CROFTON_OK);
        CHECK(statistics.size == offsetof(crofton_world_statistics, resting));
        CHECK(statistics.objects == 2);
        CHECK(std::memcmp(&statistics.resting, &before.resting,
                          sizeof statistics - offsetof(crofton_world_statistics, resting)) == 0);
        crofton_object_info info;
        std::memset(static_cast<void*>(&info), 0x5a, sizeof info);
        const crofton_object_info untouched = info;
        info.size = offsetof(crofton_object_info, transform);
        REQUIRE(crofton_world_get_object(world.get(), objects[0], &info) == CROFTON_OK);
        CHECK((info.user == 3 && info.has_box == 1 && info.has_transform == 0 && info.box.center[2] == -5));
        CHECK(std::memcmp(&info.transform, &untouched.transform, sizeof info.transform) == 0);
    }
}
