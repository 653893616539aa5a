// SPDX-License-Identifier: MIT
#include <cmath>
#include <limits>

#include "handles.hpp"

using namespace crofton::capi_test;

TEST_SUITE("capi/scene") {
    TEST_CASE("bad meshes, nodes and instances are refused, and nothing is added") {
        const Scene scene = make_scene();
        Tetrahedron tetrahedron;
        crofton_mesh mesh = tetrahedron.mesh();
        uint32_t id = 77;
        mesh.size = 4;
        CHECK(crofton_scene_add_mesh(scene.get(), &mesh, &id) == CROFTON_WRONG_SIZE);
        mesh = tetrahedron.mesh();
        mesh.indices = nullptr;
        CHECK(crofton_scene_add_mesh(scene.get(), &mesh, &id) == CROFTON_INVALID_ARGUMENT);
        tetrahedron.indices[4] = 9;
        mesh = tetrahedron.mesh();
        CHECK(crofton_scene_add_mesh(scene.get(), &mesh, &id) == CROFTON_OUT_OF_RANGE);
        CHECK(crofton_scene_add_mesh(scene.get(), nullptr, &id) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_scene_add_node(scene.get(), 5, nullptr, 1, &id) != CROFTON_OK);
        CHECK(crofton_scene_add_instance(scene.get(), 0, 0, &id) != CROFTON_OK);
        CHECK(crofton_scene_set_layer_mask(scene.get(), 0, 1) != CROFTON_OK);
        CHECK(crofton_scene_remove_instance(scene.get(), 0) != CROFTON_OK);
        CHECK(id == 77);
    }

    TEST_CASE("instances follow their nodes, and only what moved is listed") {
        const Scene scene = make_scene();
        const Tetrahedron tetrahedron;
        const crofton_mesh data = tetrahedron.mesh();
        uint32_t mesh = 0, nodes[2] = {}, instances[2] = {};
        REQUIRE(crofton_scene_add_mesh(scene.get(), &data, &mesh) == CROFTON_OK);
        for (int i = 0; i < 2; ++i) {
            REQUIRE(crofton_scene_add_node(scene.get(), CROFTON_NONE, nullptr, 1u << i, &nodes[i]) == CROFTON_OK);
            REQUIRE(crofton_scene_add_instance(scene.get(), nodes[i], mesh, &instances[i]) == CROFTON_OK);
        }
        auto statistics = sized<crofton_update_statistics>();
        REQUIRE(crofton_scene_update(scene.get(), nullptr, &statistics) == CROFTON_OK);
        CHECK(statistics.instances_updated == 2);
        const crofton_transform away = translation(100, 0, 0);
        REQUIRE(crofton_scene_set_local(scene.get(), nodes[1], &away) == CROFTON_OK);
        REQUIRE(crofton_scene_update(scene.get(), nullptr, &statistics) == CROFTON_OK);
        const uint32_t* moved = nullptr;
        std::size_t count = 0;
        REQUIRE(crofton_scene_moved(scene.get(), &moved, &count) == CROFTON_OK);
        REQUIRE(count == 1);
        CHECK(moved[0] == instances[1]);
        const crofton_box* boxes = nullptr;
        const uint32_t* masks = nullptr;
        REQUIRE(crofton_scene_boxes(scene.get(), &boxes, &masks, &count) == CROFTON_OK);
        REQUIRE(count == 2);
        CHECK(std::abs(boxes[1].center[0] - boxes[0].center[0] - 100.0) < 1e-4);
        CHECK(masks[0] == 1);
        CHECK(masks[1] == 2);
        REQUIRE(crofton_scene_remove_instance(scene.get(), instances[0]) == CROFTON_OK);
        REQUIRE(crofton_scene_update(scene.get(), nullptr, nullptr) == CROFTON_OK);
        REQUIRE(crofton_scene_boxes(scene.get(), &boxes, &masks, &count) == CROFTON_OK);
        CHECK(masks[0] == 0);
        statistics.size = 1;
        CHECK(crofton_scene_update(scene.get(), nullptr, &statistics) == CROFTON_WRONG_SIZE);
    }
}
