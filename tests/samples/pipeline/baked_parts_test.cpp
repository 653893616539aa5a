// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <box_mesh.hpp>

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "pipeline/baked_parts.hpp"
#include "pipeline/pvs_scene.hpp"

using namespace crofton;

namespace {

// Two triangles on a node each; `corner` is one of the second's.
scene::Scene two_triangles(const glm::vec3& corner, bool swapped = false) {
    scene::Scene scene;
    const auto first = scene.add_node(scene::kNone, {}), second = scene.add_node(scene::kNone, {});
    for (const bool other : {false, true}) {
        TriangleMesh mesh;
        mesh.positions = {{0, 0, 0}, {1, 0, 0}, other ? corner : glm::vec3(0, 1, 0)};
        mesh.indices = {0, 1, 2};
        REQUIRE(scene.add_instance(other != swapped ? *second : *first, *scene.add_mesh(std::move(mesh))).has_value());
    }
    return scene;
}

}  // namespace

TEST_SUITE("pipeline/baked_parts") {
    TEST_CASE("sets belong to a scene if its meshes and nodes are the same") {
        const scene::Scene scene = two_triangles({0, 2, 0});
        CHECK(pipeline::same_parts(scene, two_triangles({0, 2, 0})));
        CHECK_FALSE(pipeline::same_parts(scene, two_triangles({0, 3, 0})));
        CHECK_FALSE(pipeline::same_parts(scene, two_triangles({0, 2, 0}, true)));
        scene::Scene more = two_triangles({0, 2, 0});
        REQUIRE(more.add_node(scene::kNone, {}).has_value());
        CHECK_FALSE(pipeline::same_parts(scene, more));
    }

    // A row of houses; `shift` moves the third. Two of them may swap meshes, which leaves all counts as they are.
    TEST_CASE("visible sets of a scene with as many instances, standing elsewhere, are left out by name") {
        const auto row = [](double shift) {
            assets::SceneSource source;
            const auto mesh = source.scene.add_mesh(testing::cube_mesh()).value();
            for (int i = 0; i < 4; ++i) {
                const auto node =
                    source.scene.add_node(scene::kNone, {glm::dmat3(1.0), {4.0 * i, i == 2 ? shift : 0.0, 0.0}});
                REQUIRE(source.scene.add_instance(*node, mesh).has_value());
            }
            source.scene.update();
            source.movers = {3};
            return source;
        };
        const assets::SceneSource source = row(0.0);
        const auto made = pipeline::make_pvs_scene(source, false).value();
        const auto cells = pvs::Cells::grid({{-4.0, -2.0, 2.0}, {16.0, 2.0, 6.0}}, {2, 1, 1}).value();
        auto bake = pvs::Bake::create(made.geometry, cells, {.epsilon = 1e-2, .confidence = 0.9}).value();
        REQUIRE(bake.run().has_value());
        const pvs::Pvs sets = pvs::Pvs::finish(bake).value();
        CHECK(pipeline::is_baked_of(sets, source.scene));
        CHECK_FALSE(pipeline::is_baked_of(sets, row(0.5).scene));
        assets::SceneSource moved = row(0.0);
        REQUIRE(moved.scene.set_local(moved.scene.node_of(3), {glm::dmat3(1.0), {0.0, 9.0, 0.0}}).has_value());
        moved.scene.update();
        CHECK(pipeline::is_baked_of(sets, moved.scene));  // what moves was not baked

        const auto folder = std::filesystem::temp_directory_path() / ("crofton_parts_" + std::to_string(getpid()));
        std::filesystem::create_directories(folder);
        const std::string path = (folder / "row.crofton").string();
        const auto bytes = sets.to_file().value();
        std::ofstream(path, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        const auto own = pipeline::load_baked_parts(path, source.scene).value();
        CHECK(own.pvs != nullptr);
        CHECK(own.left_out.empty());
        const auto other = pipeline::load_baked_parts(path, row(0.5).scene).value();
        CHECK(other.pvs == nullptr);
        REQUIRE(other.left_out.size() == 1);
        CHECK(other.left_out[0].message.find("row.crofton") != std::string::npos);
        CHECK(other.left_out[0].message.find("another scene") != std::string::npos);
        std::filesystem::remove_all(folder);
    }
}
