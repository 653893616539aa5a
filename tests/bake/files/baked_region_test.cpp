// SPDX-License-Identifier: MIT
// Regions of baked scenes, beside a World of the scene's instances.
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/bake/region_files.hpp>
#include <crofton/crofton.hpp>
#include <crofton/occlude/occluder.hpp>
#include <error_of.hpp>
#include <filesystem>
#include <oracle/random_boxes.hpp>
#include <vector>

#include "../../box_mesh.hpp"
#include "forge.hpp"
#include "temporary_file.hpp"

using namespace crofton;
using namespace crofton::bake;

namespace {

TriangleMesh block(const glm::vec3& half) {
    return testing::box_mesh(-half, half);
}

// Houses of a block and a roof on one node, and crates, of which one is gone and one in a layer of its own.
struct Village {
    scene::Scene scene;
    BakedOccluders occluders;
    std::vector<MeshLook> looks{{.one_sided = true}, {}, {}};

    explicit Village(oracle::NearMisses& random) {
        const TriangleMesh house = block({4.0f, 3.0f, 5.0f});
        REQUIRE(scene.add_mesh(house));
        REQUIRE(scene.add_mesh(block({4.5f, 0.25f, 5.5f})));
        REQUIRE(scene.add_mesh(block({0.5f, 0.5f, 0.5f})));
        occluders.kinds.push_back(occlude::find_occluders(house)->occluders);
        for (int i = 0; i < 60; ++i) {
            Transform transform;
            const double x = random.number(-60.0, 60.0), z = random.number(-60.0, 60.0);
            transform.linear = glm::dmat3(oracle::random_box(random, {}, 1.0).axes);
            transform.translation = {x, 0.0, z};
            const auto node = scene.add_node(scene::kNone, transform, i == 30 ? 2u : ~0u).value();
            if (i % 3 == 0) {
                REQUIRE(scene.add_instance(node, 0));
                REQUIRE(scene.add_instance(node, 1));
                occluders.nodes.push_back({node, 0});
            } else {
                REQUIRE(scene.add_instance(node, 2));
            }
        }
        REQUIRE(scene.remove_instance(7));
        scene.update();
    }
    [[nodiscard]] Vector<std::byte> file() const {
        return bake::bake(scene, serial_executor(), {.occluders = &occluders, .looks = looks}).value();
    }
};

}  // namespace

TEST_SUITE("bake/baked_region") {
    TEST_CASE("a region of a baked file is hit, seen and hides as the instances that were baked") {
        oracle::NearMisses random(5);
        const Village village(random);
        const bake_test::TemporaryFile path(village.file());
        const glm::dvec3 origin(1e6, 0.0, -2e6);
        World world({.pairs = false}), single({.pairs = false});
        Region region;
        {
            const auto baked = BakedScene::open(path.path());
            REQUIRE(baked);
            region = prepare_region(*baked).value();
        }  // nothing of the file is needed any more
        REQUIRE(region.object_count() == village.scene.instance_count());
        std::vector<MeshHandle> meshes;
        for (scene::MeshId m = 0; m < 3; ++m)
            meshes.push_back(single
                                 .add_mesh({.positions = village.scene.mesh(m).positions,
                                            .indices = village.scene.mesh(m).indices,
                                            .occluders = m == 0})
                                 .value());
        for (std::uint32_t i = 0; i < village.scene.instance_count(); ++i) {
            if (i == 7) continue;
            Transform transform = village.scene.world(village.scene.node_of(i));
            transform.translation += origin;
            single
                .add({.mesh = meshes[village.scene.mesh_of(i)],
                      .transform = transform,
                      .user = i,
                      .layers = village.scene.layer_masks()[i]})
                .value();
        }
        const RegionHandle attached = world.attach(region, origin).value();
        for (int i = 0; i < 3; ++i) world.update().value();
        single.update().value();
        CHECK(world.statistics().occluders_waiting == 0);
        CHECK(error_of(world.transform_of(world.object_in(attached, 7).value())).code == ErrorCode::invalid_argument);
        std::size_t hits = 0, hidden = 0;
        for (int n = 0; n < 300; ++n) {
            const double x = random.number(-60.0, 60.0), z = random.number(-60.0, 60.0), u = random.number(-1.0, 1.0),
                         v = random.number(-0.05, 0.05), w = random.number(-1.0, 1.0);
            const Ray ray{origin + glm::dvec3(x, 0.0, z), {u, v, w}};
            const std::uint32_t layers = n % 2 ? 1u : 2u;
            Vector<ObjectHit> found, expected;
            world.raycast_all(ray, found, {layers});
            single.raycast_all(ray, expected, {layers});
            REQUIRE(found.size() == expected.size());
            for (std::size_t h = 0; h < found.size(); ++h) {
                CHECK(found[h].user == expected[h].user);
                CHECK(found[h].t == expected[h].t);
                CHECK(found[h].triangle == expected[h].triangle);
                CHECK(world.place_of(found[h].object)->index == expected[h].user);
            }
            hits += found.size();
            if (n % 10 != 0) continue;
            Camera camera;
            camera.position = ray.origin;
            camera.forward = ray.direction;
            const ViewRequest request{
                .camera = camera,
                .occlusion = OcclusionOptions{.max_occluders = 1000, .least_cover = 0.0f, .list_occluded = true}};
            ViewResult seen, seen_single;
            world.view(request, seen).value();
            single.view(request, seen_single).value();
            const auto users = [](const ViewResult& result, std::span<const std::uint32_t> ids) {
                std::vector<std::uint64_t> list;
                for (const std::uint32_t id : ids) list.push_back(result.ref(id).user);
                std::sort(list.begin(), list.end());
                return list;
            };
            CHECK(users(seen, seen.ids()) == users(seen_single, seen_single.ids()));
            CHECK(users(seen, seen.occluded_ids()) == users(seen_single, seen_single.occluded_ids()));
            hidden += seen.occluded_ids().size();
        }
        CHECK(hits > 300);
        CHECK(hidden > 50);
    }

    TEST_CASE("a region knows the clusters, the sides and the occluders that were baked") {
        oracle::NearMisses random(6);
        const Village village(random);
        const Vector<std::byte> file = village.file();
        const auto baked = BakedScene::from_memory(file);
        REQUIRE(baked);
        const Region region = prepare_region(*baked, {.triangles = false}).value();
        std::size_t with_occluders = 0;
        for (std::uint32_t i = 0; i < region.object_count(); ++i) {
            const std::uint32_t mesh = region.mesh_of(i);
            if (i == 7) {
                CHECK(mesh == kNoIndex);
                continue;
            }
            REQUIRE(mesh != kNoIndex);
            REQUIRE(region.clusters_of(mesh) != nullptr);
            const auto order = region.clusters_of(mesh)->triangle_order(),
                       expected = baked->clusters(village.scene.mesh_of(i))->triangle_order();
            CHECK(std::equal(order.begin(), order.end(), expected.begin(), expected.end()));
            with_occluders += !region.occluders_of(mesh).empty();
            if (!region.occluders_of(mesh).empty()) CHECK(village.scene.mesh_of(i) == 0);
        }
        CHECK(with_occluders == 20);
        const Region plain = prepare_region(*baked, {.triangles = false, .occluders = false}).value();
        for (std::uint32_t i = 0; i < plain.object_count(); ++i) {
            if (i == 7) continue;
            CHECK(plain.occluders_of(plain.mesh_of(i)).empty());
            CHECK(plain.clusters_of(plain.mesh_of(i)) != nullptr);
        }
        World world({.pairs = false});
        world.attach(region, {}).value();
        world.update().value();
        const auto hit = world.raycast({{-100.0, 0.0, 0.0}, {1.0, 0.0, 0.01}});
        REQUIRE(hit);
        CHECK(hit->triangle == kNoTriangle);  // boxes stand for the meshes
    }

    TEST_CASE(
        "a region's meshes have the boxes of the file, and a vertex outside of one is an error that names the mesh") {
        oracle::NearMisses random(8);
        const Village village(random);
        const Vector<std::byte> file = village.file();
        const auto with_crate_of = [&](float half) {
            return bake_test::with_element<MeshRecord>(file, "meshes", 2, [&](MeshRecord& mesh) {
                mesh.box = Obb();
                mesh.box.half_extents = glm::vec3(half);
            });
        };
        const Vector<std::byte> wide = with_crate_of(0.75f), narrow = with_crate_of(0.49f);
        const auto baked = BakedScene::from_memory(wide);
        REQUIRE(baked);
        const Region region = prepare_region(*baked, {.triangles = false}).value();
        World world({.pairs = false});
        const RegionHandle attached = world.attach(region, {}).value();
        std::size_t crates = 0;
        for (std::uint32_t i = 0; i < region.object_count(); ++i) {
            if (i == 7 || village.scene.mesh_of(i) != 2) continue;
            const Obb box = world.box_of(world.object_in(attached, i).value()).value();
            for (int k = 0; k < 3; ++k) CHECK(box.half_extents[k] == doctest::Approx(0.75).epsilon(1e-5));
            ++crates;
        }
        CHECK(crates > 30);
        const bake_test::TemporaryFile path(narrow);
        const std::filesystem::path place(path.path());
        const auto refused = open_region(place.parent_path().string(), {.name = place.filename().string(),
                                                                        .origin = {},
                                                                        .bounds = {glm::dvec3(-70.0), glm::dvec3(70.0)},
                                                                        .objects = village.scene.instance_count(),
                                                                        .bytes = narrow.size()});
        REQUIRE_FALSE(refused);
        CHECK(error_of(refused).item == 2);
        CHECK(error_of(refused).message.find(path.path()) != std::string::npos);
        CHECK(error_of(refused).message.find("does not contain vertex 0") != std::string::npos);
    }

    TEST_CASE("a damaged file is an error when it is opened, and too many instances when the region is prepared") {
        oracle::NearMisses random(7);
        const Village village(random);
        Vector<std::byte> file = village.file();
        {
            const auto baked = BakedScene::from_memory(file);
            REQUIRE(baked);
            BakedRegionOptions options;
            options.region.max_objects = 3;
            CHECK(error_of(prepare_region(*baked, options)).code == ErrorCode::out_of_range);
        }
        file[file.size() / 2] ^= std::byte{1};
        CHECK(!BakedScene::from_memory(file));
        scene::Scene empty;
        empty.update();
        const Vector<std::byte> nothing = bake::bake(empty).value();
        CHECK(prepare_region(*BakedScene::from_memory(nothing)).value().object_count() == 0);
    }
}
