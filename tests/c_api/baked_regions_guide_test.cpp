// SPDX-License-Identifier: MIT
// The example of docs/large_worlds.md in C.
#include <crofton/scene/scene.hpp>

#include "../region_folder.hpp"
#include "world_fixture.hpp"

using namespace crofton::capi_test;

namespace {

crofton::scene::Scene row_of_tetrahedra() {
    crofton::scene::Scene scene;
    const crofton::TriangleMesh tetrahedron{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                            .indices = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3},
                                            .colors = {}};
    const auto mesh = scene.add_mesh(tetrahedron).value();
    for (int i = 0; i < 8; ++i) {
        const crofton::Transform place{.translation = {4.0 * i, 0.0, 0.0}};
        static_cast<void>(scene.add_instance(scene.add_node(crofton::scene::kNone, place).value(), mesh).value());
    }
    scene.update();
    return scene;
}

}  // namespace

TEST_SUITE("capi/baked regions guide") {
    TEST_CASE("a region is opened by its folder's index and attached") {
        const crofton::testing::RegionFolder made(row_of_tetrahedra(), 2, 1);
        const char* const folder = made.path.c_str();
        const WorldHandle handle = make_world();
        crofton_world* const world = handle.get();
        const std::size_t near = 1;
        crofton_region* region = nullptr;
        crofton_attached_region attached{};
        const auto check = [](crofton_status status) { REQUIRE(status == CROFTON_OK); };
        /* On a thread that loads: the region that the player comes near. The last call is the game thread's. */
        crofton_region_index* index;
        const crofton_region_file* files;
        size_t count;
        check(crofton_region_index_open(folder, &index));
        check(crofton_region_index_files(index, &files, &count));
        check(crofton_region_index_prepare(index, near, NULL, NULL, &region));
        check(crofton_world_attach(world, region, files[near].origin, &attached));
        CHECK(count == 2);
        std::size_t objects = 0;
        check(crofton_world_update(world, nullptr));
        check(world_object_count(world, &objects));
        CHECK(objects == 4);
        check(crofton_region_destroy(region));
        check(crofton_region_index_destroy(index));
    }
}
