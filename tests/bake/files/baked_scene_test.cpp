// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/bake/baked_scene.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/world/world.hpp>
#include <error_of.hpp>

#include <string>

#include "forge.hpp"
#include "temporary_file.hpp"

using namespace crofton;
using namespace crofton::bake;

namespace {

// Two meshes, one of them a polygon, on a chain of nodes; an instance and a node removed.
scene::Scene sample_scene(unsigned nodes) {
    scene::Scene scene;
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.indices = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    mesh.colors.assign(4, glm::vec3(0.5f));
    REQUIRE(scene.add_mesh(mesh, "tetrahedron"));
    scene::PlanarPolygon polygon;
    polygon.polygon = {{{0, 0}, {2, 0}, {2, 1}, {0, 1}}, {4}};
    polygon.u = {0, 0, 1};
    const std::array<std::array<std::uint32_t, 3>, 2> triangles{{{0, 1, 2}, {0, 2, 3}}};
    REQUIRE(scene.add_polygon(polygon, triangles, "floor"));
    scene::NodeId parent = scene::kNone;
    for (unsigned i = 0; i < nodes; ++i) {
        Transform local;
        local.translation = {1.5, 0.0, 0.25};
        const auto node = scene.add_node(parent, local, i % 5 == 0 ? 3u : ~0u).value();
        if (i % 10 == 0) parent = node;
        REQUIRE(scene.add_instance(node, i % 2));
    }
    if (nodes > 3) REQUIRE(scene.remove_instance(3));
    if (nodes > 20) {
        REQUIRE(scene.remove_node(15));
        REQUIRE(scene.set_parent(12, 19));  // a parent of a greater id
    }
    scene.update();
    return scene;
}

bool equal(const Obb& a, const Obb& b) {
    return a.center == b.center && a.axes == b.axes && a.half_extents == b.half_extents;
}

void check_same(const scene::Scene& scene, const BakedScene& baked) {
    REQUIRE(baked.mesh_count() == scene.mesh_count());
    for (scene::MeshId i = 0; i < scene.mesh_count(); ++i) {
        const MeshView mesh = baked.mesh(i);
        CHECK(mesh.name == scene.mesh_name(i));
        CHECK(equal(mesh.box, scene.mesh_box(i)));
        CHECK(std::equal(mesh.positions.begin(), mesh.positions.end(), scene.mesh(i).positions.begin(),
                         scene.mesh(i).positions.end()));
        CHECK(std::equal(mesh.indices.begin(), mesh.indices.end(), scene.mesh(i).indices.begin(),
                         scene.mesh(i).indices.end()));
        CHECK(mesh.colors.size() == scene.mesh(i).colors.size());
        CHECK(baked.polygon(i).has_value() == (scene.polygon(i) != nullptr));
    }
    REQUIRE(baked.instances().size() == scene.instance_count());
    REQUIRE(baked.tree().boxes().size() == scene.instance_count());
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) {
        CHECK(baked.instances()[i].mesh == scene.mesh_of(i));
        CHECK(baked.instances()[i].node == scene.node_of(i));
        CHECK(equal(baked.tree().boxes()[i], scene.world_boxes()[i]));
    }
    REQUIRE(baked.nodes().size() == scene.node_count());
    for (scene::NodeId i = 0; i < scene.node_count(); ++i) {
        CHECK(baked.nodes()[i].parent == scene.parent_of(i));
        CHECK(baked.nodes()[i].world.translation == scene.world(i).translation);
    }
}

}  // namespace

TEST_SUITE("bake/baked_scene") {
    TEST_CASE("a missing file, an empty one and one of another kind are refused by name") {
        CHECK(error_of(BakedScene::open("missing.crofton")).message.find("missing.crofton") != std::string::npos);
        const bake_test::TemporaryFile empty({});
        CHECK(error_of(BakedScene::open(empty.path())).message.find(empty.path()) != std::string::npos);
        const std::string text(1000, 'x');
        const bake_test::TemporaryFile other(std::as_bytes(std::span(text)));
        CHECK(error_of(BakedScene::open(other.path())).code == ErrorCode::parse);
    }

    TEST_CASE("a file whose checksums are right but whose numbers are not is refused or harmless, never followed") {
        const auto good = bake::bake(sample_scene(4)).value();
        const auto reader = Reader::open(good).value();
        std::size_t refused = 0;
        for (std::size_t target = 0; target < reader.sections().size(); ++target)
            for (std::size_t word = 0; word + 4 <= reader.sections()[target].size; word += 4) {
                Vector<std::byte> file = good;
                std::memset(file.data() + reader.sections()[target].offset + word, 0xff, 4);
                bake_test::make_sums_right(file);
                const auto baked = BakedScene::from_memory(file);
                refused += baked ? 0 : 1;
                if (!baked) CHECK(error_of(baked).message.find("checksum") == std::string::npos);
            }
        CHECK(refused > 50);  // every link there is
    }

    TEST_CASE("an empty scene is baked and read") {
        const scene::Scene scene;
        const auto file = bake::bake(scene).value();
        const auto baked = BakedScene::from_memory(file).value();
        check_same(scene, baked);
    }

    TEST_CASE("a mesh without colours, whose arrays are empty or end with their section, is baked and read") {
        scene::Scene scene;
        TriangleMesh mesh;
        mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        mesh.indices = {0, 1, 2};
        REQUIRE(scene.add_mesh(mesh, ""));
        const auto file = bake::bake(scene).value();
        const auto baked = BakedScene::from_memory(file).value();
        check_same(scene, baked);
    }

    TEST_CASE("a baked scene comes back unchanged, from memory and from a file") {
        const scene::Scene scene = sample_scene(200);
        const auto file = bake::bake(scene).value();
        const auto from_memory = BakedScene::from_memory(file).value();
        check_same(scene, from_memory);
        const auto polygon = from_memory.polygon(1).value();
        CHECK(polygon.points.size() == 4);
        CHECK(polygon.ring_ends[0] == 4);
        CHECK(polygon.u == glm::dvec3(0, 0, 1));
        const bake_test::TemporaryFile on_disk(file);
        const auto opened = BakedScene::open(on_disk.path()).value();
        check_same(scene, opened);
    }

    TEST_CASE("looks and clusters of meshes are in the file, and a file without them says so") {
        const scene::Scene scene = sample_scene(10);
        const MeshLook looks[] = {{.one_sided = true, .unlit = true}, {.flat = true}};
        ThreadPool pool(2);
        const auto file = bake::bake(scene, pool, {.looks = looks}).value();
        const auto baked = BakedScene::from_memory(file).value();
        check_same(scene, baked);
        for (scene::MeshId i = 0; i < 2; ++i) {
            CHECK(baked.mesh(i).look == looks[i]);
            const auto cut = depth::ClusteredMesh::cut(scene.mesh(i).positions, scene.mesh(i).indices);
            REQUIRE(baked.clusters(i) != nullptr);
            CHECK(baked.clusters(i)->serialise() == cut->serialise());
        }
        const auto plain =
            bake::bake(scene, serial_executor(), {.looks = std::span(looks, 1), .clusters = false}).value();
        const auto without = BakedScene::from_memory(plain).value();
        CHECK(without.mesh(0).look == looks[0]);
        CHECK(without.mesh(1).look == MeshLook{});
        CHECK(without.clusters(0) == nullptr);
        const std::array<MeshLook, 3> too_many{};
        CHECK(error_of(bake::bake(scene, pool, {.looks = too_many})).code == ErrorCode::invalid_argument);
    }

    TEST_CASE("a World takes a file's clusters as they are, and cuts nothing") {
        const scene::Scene scene = sample_scene(10);
        const auto file = bake::bake(scene);
        const auto baked = BakedScene::from_memory(*file).value();
        World world;
        for (scene::MeshId i = 0; i < baked.mesh_count(); ++i) {
            CAPTURE(i);
            const bake::MeshView mesh = baked.mesh(i);
            REQUIRE(baked.clusters(i) != nullptr);
            const auto added = world
                                   .add_mesh({.positions = mesh.positions,
                                              .indices = mesh.indices,
                                              .clusters = true,
                                              .precut = baked.clusters(i)})
                                   .value();
            CHECK(world.clusters_of(added)->serialise() == baked.clusters(i)->serialise());
        }
    }

    TEST_CASE("a mesh that cannot be cut is baked without clusters, and other meshes keep theirs") {
        scene::Scene scene;
        for (const float size : {1.0f, 1e16f, 2.0f}) {
            TriangleMesh mesh;
            mesh.positions = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}};
            mesh.indices = {0, 1, 2};
            REQUIRE(scene.add_mesh(mesh, ""));
        }
        scene.update();
        const auto file = bake::bake(scene).value();
        const auto baked = BakedScene::from_memory(file).value();
        CHECK(baked.clusters(0) != nullptr);
        CHECK(baked.clusters(1) == nullptr);
        REQUIRE(baked.clusters(2) != nullptr);
        CHECK(baked.clusters(2)->bound().half_edges[0].x + baked.clusters(2)->bound().center.x >= 2.0f);
    }

    TEST_CASE("the same scene gives the same bytes, with any number of threads") {
        ThreadPool pool(3);
        CHECK(*bake::bake(sample_scene(300)) == *bake::bake(sample_scene(300), pool));
    }
}
