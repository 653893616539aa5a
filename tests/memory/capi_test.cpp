// SPDX-License-Identifier: MIT
// Memory ends in a call of the C API: what creates a handle says CROFTON_OUT_OF_MEMORY and leaves `*handle` alone; the
// others end the program as the C++ API does.
#include <crofton/capi/bake.h>
#include <crofton/capi/crofton.h>
#include <doctest/doctest.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "../c_api/shorthand.hpp"
#include "ending.hpp"
#include "shapes.hpp"
#include "sweep.hpp"

namespace {

using namespace crofton;
using namespace capi_test;
using testing::sweep_ending;

struct CMemory {
    CMemory() {
        crofton_memory_hooks hooks{};
        hooks.size = sizeof hooks;
        hooks.allocate = [](void*, std::size_t bytes, std::size_t alignment) {
            return testing::allocate_or_fail(bytes, alignment);
        };
        hooks.release = [](void*, void* memory, std::size_t, std::size_t) { testing::release(memory); };
        REQUIRE(crofton_set_memory_hooks(&hooks) == CROFTON_OK);
    }
    ~CMemory() { crofton_set_memory_hooks(nullptr); }
    CMemory(const CMemory&) = delete;
    CMemory& operator=(const CMemory&) = delete;
};

testing::Outcome outcome_of(crofton_status status) {
    if (status == CROFTON_OK) return {};
    return status == CROFTON_OUT_OF_MEMORY ? ErrorCode::out_of_memory : ErrorCode::invalid_argument;
}

// Creates and destroys. A handle that could not be created must not have been written.
template <class Handle, class Create>
void sweep_create(const char* name, const Create& create, crofton_status (*destroy)(Handle*)) {
    bool is_untouched = true;
    testing::sweep(
        name,
        [&] {
            Handle* handle = nullptr;
            const crofton_status status = create(&handle);
            is_untouched = status == CROFTON_OK || handle == nullptr;
            if (status == CROFTON_OK) destroy(handle);
            return outcome_of(status);
        },
        [&] { return is_untouched; });
}

crofton_box box_at(double x, double y, double z) {
    return {{x, y, z}, {1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.5f, 0.5f, 0.5f}};
}

std::vector<crofton_box> row_of_boxes(int count) {
    std::vector<crofton_box> result;
    for (int i = 0; i < count; ++i) result.push_back(box_at(0.75 * i, 0.25 * (i % 3), -4.0 - i % 5));
    return result;
}

View default_view() {
    crofton_camera camera = crofton_default_camera();
    View view;
    view.frustum.size = sizeof view.frustum;
    crofton_frustum_from_camera(&camera, &view.frustum);
    return view;
}

struct Sail {
    float positions[9] = {0, 0, -4, 1, 0, -4, 0, 1, -4};
    std::uint32_t indices[3] = {0, 1, 2};
    crofton_mesh mesh{sizeof(crofton_mesh), positions, 3, indices, 3, "a sail, with a name that is long enough"};
};

}  // namespace

TEST_SUITE("memory/capi") {
    TEST_CASE("functions that create a handle") {
        const CMemory memory;
        sweep_create<crofton_scene>("scene", crofton_scene_create, crofton_scene_destroy);
        sweep_create<crofton_broadphase>("broadphase", crofton_broadphase_create, crofton_broadphase_destroy);
        sweep_create<crofton_triangulator>("triangulator", crofton_triangulator_create, crofton_triangulator_destroy);
        sweep_create<crofton_found>("found", crofton_found_create, crofton_found_destroy);
        sweep_create<crofton_view_result>("view result", crofton_view_result_create, crofton_view_result_destroy);
        sweep_create<crofton_world>(
            "world", [](crofton_world** world) { return crofton_world_create(nullptr, world); }, crofton_world_destroy);
        const auto boxes = row_of_boxes(300);
        sweep_create<crofton_tree>(
            "tree",
            [&](crofton_tree** tree) {
                return crofton_tree_create(boxes.data(), nullptr, boxes.size(), nullptr, tree);
            },
            crofton_tree_destroy);
        const Sail sail;
        sweep_create<crofton_shape>(
            "shape of a mesh", [&](crofton_shape** shape) { return shape_mesh(&sail.mesh, 0, shape); },
            crofton_shape_destroy);
        sweep_create<crofton_clustered_mesh>(
            "clustered mesh",
            [&](crofton_clustered_mesh** clustered) { return crofton_clustered_mesh_create(&sail.mesh, 0, clustered); },
            crofton_clustered_mesh_destroy);
        sweep_create<crofton_depth_culler>("depth culler", crofton_depth_culler_create, crofton_depth_culler_destroy);
    }

    TEST_CASE("boxes, triangulations, files") {
        const CMemory memory;
        const auto cloud = testing::points(100);
        crofton_box box{};
        testing::sweep("fit_points",
                       [&] { return outcome_of(crofton_fit_points(&cloud[0].x, cloud.size(), 0, nullptr, &box)); });
        const auto boxes = row_of_boxes(20);
        testing::sweep("fit_boxes",
                       [&] { return outcome_of(crofton_fit_boxes(boxes.data(), boxes.size(), nullptr, &box)); });

        crofton_scene* scene = nullptr;
        REQUIRE(crofton_scene_create(&scene) == CROFTON_OK);
        const Sail sail;
        std::uint32_t mesh = 0, node = 0, instance = 0;
        REQUIRE(crofton_scene_add_mesh(scene, &sail.mesh, &mesh) == CROFTON_OK);
        REQUIRE(crofton_scene_add_node(scene, CROFTON_NONE, nullptr, ~0u, &node) == CROFTON_OK);
        REQUIRE(crofton_scene_add_instance(scene, node, mesh, &instance) == CROFTON_OK);
        REQUIRE(crofton_scene_update(scene, nullptr, nullptr) == CROFTON_OK);
        const std::string path =
            (std::filesystem::temp_directory_path() / ("crofton-capi-memory-" + std::to_string(getpid()))).string();
        const auto bake = [&] { return crofton_scene_bake(scene, path.c_str(), nullptr); };
        REQUIRE(bake() == CROFTON_OK);
        testing::sweep(
            "scene_bake", [&] { return outcome_of(bake()); },
            [&] {  // the old file, whole; and nothing beside it
                crofton_baked_scene* baked = nullptr;
                crofton_tree* tree = nullptr;
                if (crofton_baked_scene_open(path.c_str(), nullptr, &baked, &tree) != CROFTON_OK) return false;
                crofton_tree_destroy(tree);
                crofton_baked_scene_destroy(baked);
                return !std::filesystem::exists(path + ".partial");
            });
        for (const auto open : {crofton_baked_scene_open, crofton_baked_scene_read}) {
            sweep_create<crofton_baked_scene>(
                "baked_scene_open, baked_scene_read",
                [&](crofton_baked_scene** baked) {
                    crofton_tree* tree = nullptr;
                    const crofton_status status = open(path.c_str(), nullptr, baked, &tree);
                    if (status == CROFTON_OK) crofton_tree_destroy(tree);
                    return status;
                },
                crofton_baked_scene_destroy);
        }
        std::filesystem::remove(path);
        CHECK(crofton_scene_destroy(scene) == CROFTON_OK);
    }

    TEST_CASE("calls that end the program") {
        const CMemory memory;
        const auto boxes = row_of_boxes(300);
        const View view = default_view();
        crofton_tree* tree = nullptr;
        REQUIRE(crofton_tree_create(boxes.data(), nullptr, boxes.size(), nullptr, &tree) == CROFTON_OK);
        crofton_view_result* visible = nullptr;
        REQUIRE(crofton_view_result_create(&visible) == CROFTON_OK);
        sweep_ending("tree: cull, insert, move, refit, rebuild", [&] {
            cull_tree(tree, &view, nullptr, nullptr, visible);
            for (std::uint32_t i = 0; i < 100; ++i) {
                std::uint32_t item = 0;
                crofton_tree_insert(tree, &boxes[i], ~0u, &item);
                crofton_tree_move(tree, &item, &boxes[i + 1], 1);
            }
            for (int i = 0; i < 20; ++i) crofton_tree_refit(tree, 5000);
        });
        sweep_ending("tree: spheres and boxes", [&] {
            std::uint32_t items[8];
            std::size_t found = 0;
            tree_within_box(tree, &boxes[0], ~0u, items, 8, &found);
            const double center[3] = {0, 0, -4};
            tree_within_sphere(tree, center, 2.0, ~0u, items, 8, &found);
        });
        sweep_ending("list of boxes",
                     [&] { cull_boxes(boxes.data(), nullptr, boxes.size(), &view, nullptr, nullptr, visible); });
        crofton_broadphase* broadphase = nullptr;
        REQUIRE(crofton_broadphase_create(&broadphase) == CROFTON_OK);
        sweep_ending("broadphase",
                     [&] { crofton_broadphase_update(broadphase, boxes.data(), nullptr, boxes.size(), nullptr); });
        crofton_world* world = nullptr;
        REQUIRE(crofton_world_create(nullptr, &world) == CROFTON_OK);
        sweep_ending("world", [&] {
            for (const crofton_box& box : boxes) {
                crofton_bound bound{};
                bound.kind = CROFTON_BOUND_BOX;
                bound.box = box;
                crofton_object_description description = crofton_default_object_description();
                description.bound = &bound;
                crofton_object object{};
                crofton_world_add(world, &description, &object);
            }
            crofton_world_update(world, nullptr);
            crofton_view_result* seen = nullptr;
            if (crofton_view_result_create(&seen) != CROFTON_OK) return;
            crofton_view_request request = crofton_default_view_request();
            request.volume = &view.frustum;
            crofton_world_view(world, &request, 1, nullptr, seen);
            crofton_found* found = nullptr;
            if (crofton_found_create(&found) != CROFTON_OK) return;
            world_overlap(world, &boxes[0], nullptr, found);
        });
        CHECK(crofton_world_destroy(world) == CROFTON_OK);
        CHECK(crofton_broadphase_destroy(broadphase) == CROFTON_OK);
        CHECK(crofton_view_result_destroy(visible) == CROFTON_OK);
        CHECK(crofton_tree_destroy(tree) == CROFTON_OK);
        MESSAGE(testing::failures_tried << " allocations failed with an Error, " << testing::endings_tried
                                        << " ended a process or went on");
    }
}
