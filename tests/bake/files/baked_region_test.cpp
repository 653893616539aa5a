// SPDX-License-Identifier: MIT
// Regions of baked scenes, beside a World of the scene's instances.
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/bake/region_files.hpp>
#include <crofton/boxtree/layout.hpp>
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

// Where a stored tree has its nodes and leaves, from the begin of its section on: after 104 bytes, of which five counts
// begin at the fortieth.
struct StoredTree {
    std::uint64_t boxes = 0, free_items = 0, axes = 0, nodes = 0, leaves = 0;

    [[nodiscard]] std::size_t nodes_begin() const {
        return 104 + boxes * (sizeof(Obb) + 4) + free_items * 4 + axes * sizeof(boxtree::Axes);
    }
    [[nodiscard]] std::size_t leaves_begin() const {
        return nodes_begin() +
               nodes * (sizeof(boxtree::Node) + sizeof(boxtree::LeafRange) + sizeof(boxtree::NodeRadii));
    }
    [[nodiscard]] std::size_t slots_begin() const {
        return leaves_begin() + leaves * (sizeof(boxtree::Leaf) + 1 + sizeof(boxtree::RadiusRange));
    }
};

// Changes the tree of a file and makes its checksums right.
template <class Change>
Vector<std::byte> with_tree(const Vector<std::byte>& file, Change change) {
    return bake_test::with_table(file, [&](Header& header, Section* sections) {
        for (std::uint32_t i = 0; i < header.section_count; ++i) {
            if (std::string_view(sections[i].name, 5) != std::string_view("tree", 5)) continue;
            std::byte* const tree = reinterpret_cast<std::byte*>(&header) + sections[i].offset;
            StoredTree places;
            std::memcpy(&places, tree + 40, sizeof places);
            return change(tree, places);
        }
        FAIL("no tree");
    });
}

// Changes a block of a file, which is not aligned in memory.
template <class Block, class Change>
void change_block(std::byte* place, Change change) {
    Block block;
    std::memcpy(static_cast<void*>(&block), place, sizeof block);
    change(block);
    std::memcpy(place, &block, sizeof block);
}

std::vector<std::uint64_t> seen_in(const Region& region, const Camera& camera) {
    World world({.pairs = false});
    REQUIRE(world.attach(region, {}));
    REQUIRE(world.update());
    ViewResult visible;
    REQUIRE(world.view({.camera = camera}, visible));
    std::vector<std::uint64_t> users;
    for (std::size_t i = 0; i < visible.size(); ++i) users.push_back(visible[i].user);
    return users;
}

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
            const auto baked = BakedScene::open(path.path()).value();
            region = prepare_region(baked).value();
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
        const auto baked = BakedScene::from_memory(file).value();
        const Region region = prepare_region(baked, {.triangles = false}).value();
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
                       expected = baked.clusters(village.scene.mesh_of(i))->triangle_order();
            CHECK(std::equal(order.begin(), order.end(), expected.begin(), expected.end()));
            with_occluders += !region.occluders_of(mesh).empty();
            if (!region.occluders_of(mesh).empty()) CHECK(village.scene.mesh_of(i) == 0);
        }
        CHECK(with_occluders == 20);
        const Region plain = prepare_region(baked, {.triangles = false, .occluders = false}).value();
        for (std::uint32_t i = 0; i < plain.object_count(); ++i) {
            if (i == 7) continue;
            CHECK(plain.occluders_of(plain.mesh_of(i)).empty());
            CHECK(plain.clusters_of(plain.mesh_of(i)) != nullptr);
        }
        World world({.pairs = false});
        world.attach(region, {}).value();
        world.update().value();
        const auto hit = world.raycast({{-100.0, 0.0, 0.0}, {1.0, 0.0, 0.01}}).value();
        CHECK(hit.triangle == kNoTriangle);  // boxes stand for the meshes
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
        const auto baked = BakedScene::from_memory(wide).value();
        const Region region = prepare_region(baked, {.triangles = false}).value();
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
            const auto baked = BakedScene::from_memory(file).value();
            BakedRegionOptions options;
            options.region.max_objects = 3;
            CHECK(error_of(prepare_region(baked, options)).code == ErrorCode::out_of_range);
        }
        file[file.size() / 2] ^= std::byte{1};
        CHECK(!BakedScene::from_memory(file));
        scene::Scene empty;
        empty.update();
        const Vector<std::byte> nothing = bake::bake(empty).value();
        CHECK(prepare_region(*BakedScene::from_memory(nothing)).value().object_count() == 0);
    }

    TEST_CASE("a forged tree whose sums are right is refused before it is attached, or finds what is there") {
        oracle::NearMisses random(8);
        const Village village(random);
        const Vector<std::byte> file =
            bake::bake(village.scene, serial_executor(), {.region_max_origin = RegionOptions().max_origin}).value();
        BakedRegionOptions trusting;
        trusting.trust_contents = true;
        const auto prepare_of = [](const Vector<std::byte>& forged, const BakedRegionOptions& options = {}) {
            auto baked = BakedScene::from_memory(forged);
            return baked ? prepare_region(std::move(*baked), options) : Result<Region>(baked.error());
        };
        const auto refused = [&](auto change, std::string_view why, bool by_links) {
            const Vector<std::byte> forged = with_tree(file, change);
            const auto region = prepare_of(forged);
            REQUIRE_FALSE(region);
            CHECK(error_of(region).code == ErrorCode::parse);
            INFO(error_of(region).message);
            CHECK(error_of(region).message.find(why) != std::string::npos);
            CHECK(prepare_of(forged, trusting).has_value() != by_links);
        };
        REQUIRE(prepare_of(file));
        const auto in_node = [](auto change) {
            return [=](std::byte* tree, const StoredTree& at) {
                change_block<boxtree::Node>(tree + at.nodes_begin(), change);
            };
        };
        const auto in_leaf = [](auto change) {
            return [=](std::byte* tree, const StoredTree& at) {
                change_block<boxtree::Leaf>(tree + at.leaves_begin(), change);
            };
        };
        // Contents, which no link depends on.
        refused(in_node([](boxtree::Node& n) { n.half_xy[0] = boxtree::pair_of(0, 0); }),
                "a bound does not contain the boxes below it", false);
        refused(in_node([](boxtree::Node& n) { n.origin[1] += 1.0; }), "a bound does not contain the boxes below it",
                false);
        refused(in_node([](boxtree::Node& n) { n.rounding = -1.0f; }), "frame", false);
        refused(in_node([](boxtree::Node& n) { n.layers_any[0] = 0; }), "layers do not match", false);
        refused(in_leaf([](boxtree::Leaf& l) { l.xy[0] ^= 0x100; }), "does not match its box", false);
        refused(in_leaf([](boxtree::Leaf& l) { l.layers[1] = 0; }), "layers do not match", false);
        // Links.
        refused(in_node([](boxtree::Node& n) { n.child[0] = 0; }), "does not know its parent", true);
        refused(in_node([](boxtree::Node& n) { n.child[0] = 1000000; }), "does not exist", true);
        refused(in_node([](boxtree::Node& n) { n.child[0] = n.child[1]; }), "does not know its parent", true);
        refused(
            [](std::byte* t, const StoredTree& at) {
                change_block<std::uint32_t>(t + at.slots_begin(), [](std::uint32_t& slot) { slot = 1000000; });
            },
            "is not where its slot says", true);

        Camera camera;
        camera.position = {0.0, 2.0, 0.0};
        camera.forward = {1.0, 0.0, 0.3};
        const auto expected = seen_in(prepare_of(file).value(), camera);
        REQUIRE(expected.size() > 3);
        int taken = 0;
        for (int i = 0; i < 2000; ++i) {
            const auto region = prepare_of(with_tree(file, [&](std::byte* tree, const StoredTree& at) {
                const std::size_t begin = at.nodes_begin(), size = at.slots_begin() + 64 * at.leaves - begin;
                tree[begin + static_cast<std::size_t>(random.number(0.0, static_cast<double>(size)))] ^=
                    static_cast<std::byte>(1u << static_cast<unsigned>(random.number(0.0, 8.0)));
            }));
            if (!region) continue;
            ++taken;
            CHECK(seen_in(*region, camera) == expected);
        }
        CHECK(taken < 1000);
    }
}
