// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "../kill_writer.hpp"
#include "handles.hpp"

using namespace crofton::capi_test;

namespace {

using BakedScene = Owned<crofton_baked_scene, crofton_baked_scene_destroy>;

// A file of its own, gone at the end.
struct TemporaryFile {
    std::string path = (std::filesystem::temp_directory_path() / ("crofton_capi_" + std::to_string(getpid()))).string();
    ~TemporaryFile() { std::filesystem::remove(path); }
};

// A baked scene and its tree.
struct Opened {
    BakedScene baked;
    Tree tree;
};

template <class Open>
Opened opened(const TemporaryFile& file, Open open) {
    crofton_baked_scene* baked = nullptr;
    crofton_tree* tree = nullptr;
    REQUIRE(open(file.path.c_str(), nullptr, &baked, &tree) == CROFTON_OK);
    return {BakedScene(baked), Tree(tree)};
}

// A row of tetrahedra along −z, every second in a layer of its own.
Scene row(int count) {
    Scene scene = make_scene();
    const Tetrahedron tetrahedron;
    const crofton_mesh data = tetrahedron.mesh();
    uint32_t mesh = 0, root = 0, node = 0, instance = 0;
    REQUIRE(crofton_scene_add_mesh(scene.get(), &data, &mesh) == CROFTON_OK);
    REQUIRE(crofton_scene_add_node(scene.get(), CROFTON_NONE, nullptr, ~0u, &root) == CROFTON_OK);
    for (int i = 0; i < count; ++i) {
        const crofton_transform place = translation(0, 0, -2.0 * (i + 1));
        REQUIRE(crofton_scene_add_node(scene.get(), root, &place, 1u << i % 2, &node) == CROFTON_OK);
        REQUIRE(crofton_scene_add_instance(scene.get(), node, mesh, &instance) == CROFTON_OK);
    }
    REQUIRE(crofton_scene_update(scene.get(), nullptr, nullptr) == CROFTON_OK);
    return scene;
}

std::vector<std::uint32_t> seen(const crofton_tree* tree, std::uint32_t layers) {
    const VisibleSet visible = make_visible_set();
    View view = default_view();
    view.layer_mask = layers;
    REQUIRE(cull_tree(tree, &view, nullptr, nullptr, visible.get()) == CROFTON_OK);
    const uint32_t* ids = nullptr;
    std::size_t count = 0;
    REQUIRE(visible_set_items(visible.get(), &ids, nullptr, &count) == CROFTON_OK);
    return {ids, ids + count};
}

}  // namespace

TEST_SUITE("capi/bake") {
    TEST_CASE(
        "NULL, files that are missing or damaged and places that cannot be written are refused, with their path") {
        const Scene scene = row(2);
        crofton_baked_scene* baked = nullptr;
        crofton_tree* tree = nullptr;
        CHECK(crofton_scene_bake(nullptr, "x", nullptr) == CROFTON_BAD_HANDLE);
        CHECK(crofton_scene_bake(scene.get(), nullptr, nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_scene_bake(scene.get(), "/nowhere/at/all", nullptr) == CROFTON_IO);
        CHECK(mentions(crofton_last_error(), "/nowhere/at/all"));
        CHECK(crofton_baked_scene_open(nullptr, nullptr, &baked, &tree) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_baked_scene_open("/nowhere", nullptr, nullptr, &tree) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_baked_scene_open("/nowhere", nullptr, &baked, nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_baked_scene_open("/nowhere", nullptr, &baked, &tree) == CROFTON_IO);
        const TemporaryFile file;
        REQUIRE(crofton_scene_bake(scene.get(), file.path.c_str(), nullptr) == CROFTON_OK);
        std::fstream(file.path, std::ios::in | std::ios::out | std::ios::binary).seekp(200).put('?');
        CHECK(crofton_baked_scene_open(file.path.c_str(), nullptr, &baked, &tree) == CROFTON_PARSE);
        CHECK(mentions(crofton_last_error(), file.path.c_str()));
        CHECK(baked == nullptr);
        CHECK(tree == nullptr);
        CHECK(crofton_baked_scene_destroy(nullptr) == CROFTON_BAD_HANDLE);
    }

    TEST_CASE("a baked mesh has the clusters of a freshly cut one, and they outlive the scene") {
        const Scene scene = row(3);
        const TemporaryFile file;
        REQUIRE(crofton_scene_bake(scene.get(), file.path.c_str(), nullptr) == CROFTON_OK);
        auto [baked, tree] = opened(file, crofton_baked_scene_open);
        crofton_clustered_mesh* handle = nullptr;
        CHECK(crofton_baked_scene_clusters(nullptr, 0, &handle) == CROFTON_BAD_HANDLE);
        CHECK(crofton_baked_scene_clusters(baked.get(), 0, nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_baked_scene_clusters(baked.get(), 1, &handle) == CROFTON_OUT_OF_RANGE);
        REQUIRE(crofton_baked_scene_clusters(baked.get(), 0, &handle) == CROFTON_OK);
        const ClusteredMesh stored(handle);
        auto mesh = sized<crofton_baked_mesh>();
        REQUIRE(crofton_baked_scene_mesh(baked.get(), 0, &mesh) == CROFTON_OK);
        CHECK(mesh.one_sided + mesh.flat + mesh.unlit == 0);
        baked = BakedScene();
        const Tetrahedron tetrahedron;
        const crofton_mesh data = tetrahedron.mesh();
        REQUIRE(crofton_clustered_mesh_create(&data, 0, &handle) == CROFTON_OK);
        const ClusteredMesh cut(handle);
        crofton_clusters a{}, b{};
        REQUIRE(crofton_clustered_mesh_get(stored.get(), &a) == CROFTON_OK);
        REQUIRE(crofton_clustered_mesh_get(cut.get(), &b) == CROFTON_OK);
        REQUIRE(a.cluster_count == b.cluster_count);
        REQUIRE(a.triangle_count == b.triangle_count);
        CHECK(std::memcmp(a.clusters, b.clusters, a.cluster_count * sizeof *a.clusters) == 0);
        CHECK(std::equal(a.triangle_order, a.triangle_order + a.triangle_count, b.triangle_order));
    }

    TEST_CASE("a baked scene comes back: meshes, instances, nodes, and a tree that sees what a fresh one sees") {
        const Scene scene = row(40);
        const TemporaryFile file;
        REQUIRE(crofton_scene_bake(scene.get(), file.path.c_str(), nullptr) == CROFTON_OK);
        auto [baked, tree] = opened(file, crofton_baked_scene_open);

        std::size_t count = 0;
        REQUIRE(crofton_baked_scene_mesh_count(baked.get(), &count) == CROFTON_OK);
        CHECK(count == 1);
        auto mesh = sized<crofton_baked_mesh>();
        REQUIRE(crofton_baked_scene_mesh(baked.get(), 0, &mesh) == CROFTON_OK);
        const Tetrahedron tetrahedron;
        CHECK(std::string(mesh.name, mesh.name_length) == "tetrahedron");
        CHECK(std::vector<float>(mesh.positions, mesh.positions + 3 * mesh.vertex_count) == tetrahedron.positions);
        CHECK(std::vector<std::uint32_t>(mesh.indices, mesh.indices + mesh.index_count) == tetrahedron.indices);
        CHECK(mesh.colors == nullptr);
        CHECK(mesh.box.half_extents[0] > 0.0f);
        CHECK(crofton_baked_scene_mesh(baked.get(), 1, &mesh) == CROFTON_OUT_OF_RANGE);
        mesh.size = 8;
        CHECK(crofton_baked_scene_mesh(baked.get(), 0, &mesh) == CROFTON_WRONG_SIZE);

        const crofton_baked_instance* instances = nullptr;
        REQUIRE(crofton_baked_scene_instances(baked.get(), &instances, &count) == CROFTON_OK);
        REQUIRE(count == 40);
        const crofton_baked_node* nodes = nullptr;
        std::size_t node_count = 0;
        REQUIRE(crofton_baked_scene_nodes(baked.get(), &nodes, &node_count) == CROFTON_OK);
        REQUIRE(node_count == 41);
        CHECK(nodes[0].parent == CROFTON_NONE);
        for (std::uint32_t i = 0; i < 40; ++i) {
            CHECK(instances[i].mesh == 0);
            CHECK(instances[i].node == i + 1);
            CHECK(nodes[i + 1].parent == 0);
            CHECK(nodes[i + 1].world.translation[2] == -2.0 * (i + 1));
        }

        const crofton_box* boxes = nullptr;
        const uint32_t* masks = nullptr;
        REQUIRE(crofton_scene_boxes(scene.get(), &boxes, &masks, &count) == CROFTON_OK);
        crofton_tree* built = nullptr;
        REQUIRE(crofton_tree_create(boxes, masks, count, nullptr, &built) == CROFTON_OK);
        const Tree fresh(built);
        for (const std::uint32_t layers : {1u, 2u, 3u, 4u})
            CHECK(seen(tree.get(), layers) == seen(fresh.get(), layers));
        CHECK(seen(tree.get(), 3u).size() == 40);
        // The tree outlives the file and may change.
        baked.reset();
        REQUIRE(crofton_tree_remove(tree.get(), 7) == CROFTON_OK);
        REQUIRE(crofton_tree_refit(tree.get(), 0) == CROFTON_OK);
        CHECK(seen(tree.get(), 3u).size() == 39);
    }

    TEST_CASE("baking over a file that is open leaves its reader what it has, and a failed one the old file") {
        const TemporaryFile file;
        const Scene large = row(4000), small = row(1);
        REQUIRE(crofton_scene_bake(large.get(), file.path.c_str(), nullptr) == CROFTON_OK);
        const auto [baked, tree] = opened(file, crofton_baked_scene_open);
        REQUIRE(crofton_scene_bake(small.get(), file.path.c_str(), nullptr) == CROFTON_OK);
        const crofton_baked_node* nodes = nullptr;
        std::size_t count = 0;
        REQUIRE(crofton_baked_scene_nodes(baked.get(), &nodes, &count) == CROFTON_OK);
        REQUIRE(count == 4001);
        CHECK(nodes[4000].world.translation[2] == -8000.0);
        CHECK_FALSE(std::filesystem::exists(file.path + ".partial"));
    }

    TEST_CASE("killed while it bakes, the C API leaves the old file or the new one, and the next bake cleans up") {
        const TemporaryFile file;
        const Scene scenes[] = {row(3000), row(3001)};
        REQUIRE(crofton_scene_bake(scenes[0].get(), file.path.c_str(), nullptr) == CROFTON_OK);
        for (int i = 0; i < crofton::testing::kill_count(); ++i) {
            const auto bake = [&](std::uint64_t round) {
                return crofton_scene_bake(scenes[round % 2].get(), file.path.c_str(), nullptr) == CROFTON_OK;
            };
            CHECK(crofton::testing::kill_while_writing(bake, static_cast<std::uint64_t>(i), 10'000));
            const auto [baked, tree] = opened(file, crofton_baked_scene_read);
        }
        REQUIRE(crofton_scene_bake(scenes[0].get(), file.path.c_str(), nullptr) == CROFTON_OK);
        CHECK_FALSE(std::filesystem::exists(file.path + ".partial"));
    }

    TEST_CASE("a baked scene that was read into memory outlives its file being cut") {
        const TemporaryFile file;
        const Scene scene = row(4000);
        REQUIRE(crofton_scene_bake(scene.get(), file.path.c_str(), nullptr) == CROFTON_OK);
        const auto [baked, tree] = opened(file, crofton_baked_scene_read);
        std::filesystem::resize_file(file.path, 100);
        const crofton_baked_node* nodes = nullptr;
        std::size_t count = 0;
        REQUIRE(crofton_baked_scene_nodes(baked.get(), &nodes, &count) == CROFTON_OK);
        REQUIRE(count == 4001);
        CHECK(nodes[4000].world.translation[2] == -8000.0);
    }
}
