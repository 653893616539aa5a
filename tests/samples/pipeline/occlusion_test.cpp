// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <box_mesh.hpp>
#include <crofton/render/device.hpp>

#include "pipeline/owner_picture.hpp"
#include "pipeline/scene_occluders.hpp"
#include "pipeline/verify.hpp"

using namespace crofton;
using namespace crofton::pipeline;

namespace {

// A wall at z = −10, a row of small cubes behind it, and one beside it; the camera at the origin looks along −z.
struct Yard {
    scene::Scene scene;
    scene::NodeId wall_node = scene::kNone;
    scene::InstanceId wall = 0, beside = 0;
    std::vector<scene::InstanceId> behind, all;

    Yard() {
        const auto wall_mesh = scene.add_mesh(testing::box_mesh({-4.0f, -4.0f, -0.5f}, {4.0f, 4.0f, 0.5f}));
        const auto cube = scene.add_mesh(testing::cube_mesh(0.3f));
        wall_node = *scene.add_node(scene::kNone, {glm::dmat3(1.0), {0.0, 0.0, -10.0}});
        wall = *scene.add_instance(wall_node, *wall_mesh);
        for (int i = -2; i <= 2; ++i) {
            const auto node = scene.add_node(scene::kNone, {glm::dmat3(1.0), {1.0 * i, 0.0, -15.0}});
            behind.push_back(*scene.add_instance(*node, *cube));
        }
        beside = *scene.add_instance(*scene.add_node(scene::kNone, {glm::dmat3(1.0), {6.5, 0.0, -10.0}}), *cube);
        scene.update();
        for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) all.push_back(i);
    }
};

const PipelineOptions kWithOcclusion{.occlusion = OcclusionOptions{}};

}  // namespace

TEST_SUITE("pipeline/occlusion") {
    TEST_CASE("an object behind a wall is not listed, and is again once the wall has moved away or is hidden") {
        for (const bool moves : {true, false}) {
            CAPTURE(moves);
            Yard yard;
            auto pipeline = Pipeline::create(yard.scene, {}, kWithOcclusion, serial_executor()).value();
            auto frame = pipeline.run(Camera{});
            REQUIRE(frame.has_value());
            REQUIRE(frame->occlusion.has_value());
            CHECK(frame->visible_ids == yard.all);
            CHECK(frame->occlusion->visible_ids == std::vector<std::uint32_t>{yard.wall, yard.beside});
            CHECK(frame->occlusion->occluders >= 1);
            CHECK(frame->occlusion->triangles_submitted == 24);
            CHECK(frame->triangles_submitted == 84);
            if (moves)
                REQUIRE(yard.scene.set_local(yard.wall_node, {glm::dmat3(1.0), {0.0, 50.0, -60.0}}).has_value());
            else
                REQUIRE(yard.scene.set_instance_layers(yard.wall, 0).has_value());
            yard.scene.update();
            frame = pipeline.run(Camera{});
            REQUIRE(frame.has_value());
            for (const scene::InstanceId i : yard.behind)
                CHECK(
                    std::binary_search(frame->occlusion->visible_ids.begin(), frame->occlusion->visible_ids.end(), i));
        }
    }

    // A wall of strips, of which every other one is two pieces. Alone each leaves the pixels on its sides open.
    TEST_CASE("a node of many meshes is a level, whose pieces hide together, also from a file") {
        for (const int strips : {4, 12}) {
            CAPTURE(strips);
            Yard yard;
            REQUIRE(yard.scene.set_instance_layers(yard.wall, 0).has_value());
            const auto node = yard.scene.add_node(scene::kNone, {glm::dmat3(1.0), {0.0, 0.0, -10.0}});
            const auto add = [&](double left, double right, double low, double high) {
                TriangleMesh piece;
                for (const auto& [x, y] : {std::pair{left, low}, {right, low}, {right, high}, {left, high}})
                    piece.positions.emplace_back(x, y, 0.0);
                piece.indices = {0, 1, 2, 0, 2, 3};
                REQUIRE(yard.scene.add_instance(*node, *yard.scene.add_mesh(std::move(piece))).has_value());
            };
            for (int i = 0; i < strips; ++i) {
                const double left = -4.0 + 8.0 * i / strips, right = -4.0 + 8.0 * (i + 1) / strips;
                if (i % 2 == 0) add(left, right, -4.0, 4.0);
                if (i % 2 == 1) add(left, right, -4.0, 0.125);
                if (i % 2 == 1) add(left, right, 0.125, 4.0);
            }
            yard.scene.update();
            const SceneOccluders found = find_scene_occluders(yard.scene, serial_executor());
            const auto level =
                std::find_if(found.kinds.begin(), found.kinds.end(), [](const auto& kind) { return kind.is_level; });
            REQUIRE((level != found.kinds.end()) == (strips == 12));
            if (strips == 4) continue;
            CHECK(level->found.covered == level->found.mean_shadow);
            std::size_t triangles = 0;
            for (const occlude::FoundOccluder& surface : level->found.occluders) {
                CHECK(surface.kind == occlude::OccluderKind::patch);
                triangles += surface.surface.triangle_count();
            }
            CHECK(triangles == 36 + 11);  // each whole strip is cut on both sides, but for the first on its left
            const bake::BakedOccluders baked = to_baked(found);
            const auto file = bake::bake(yard.scene, serial_executor(), {.occluders = &baked}).value();
            const SceneOccluders back =
                scene_occluders_from(yard.scene, *bake::BakedScene::from_memory(file).value().occluders());
            for (const SceneOccluders& occluders : {found, back}) {
                auto pipeline = Pipeline::create(yard.scene, {}, kWithOcclusion, serial_executor(),
                                                 std::make_shared<const SceneOccluders>(occluders))
                                    .value();
                const auto frame = pipeline.run(Camera{});
                for (const scene::InstanceId i : yard.behind)
                    CHECK_FALSE(std::binary_search(frame->occlusion->visible_ids.begin(),
                                                   frame->occlusion->visible_ids.end(), i));
            }
        }
    }

    TEST_CASE("switched on, off and on again a pipeline answers as a new one, and finds its occluders once") {
        Yard yard;
        auto pipeline = Pipeline::create(yard.scene, {}, {}, serial_executor());
        REQUIRE(pipeline.has_value());
        CHECK_FALSE(pipeline->run(Camera{})->occlusion.has_value());
        CHECK(pipeline->occluders() == nullptr);
        const World* world = &pipeline->world();
        REQUIRE(pipeline->set_options(kWithOcclusion).has_value());
        const auto occluders = pipeline->occluders();
        REQUIRE(occluders != nullptr);
        const std::vector<std::uint32_t> expected{yard.wall, yard.beside};
        CHECK(pipeline->run(Camera{})->occlusion->visible_ids == expected);
        REQUIRE(pipeline->set_options({}).has_value());
        const auto without = pipeline->run(Camera{});
        CHECK_FALSE(without->occlusion.has_value());
        CHECK(without->visible_ids == yard.all);
        REQUIRE(pipeline->set_options({.cull = CullMode::flat, .occlusion = OcclusionOptions{}}).has_value());
        const auto flat = pipeline->run(Camera{});
        CHECK(flat->occlusion->visible_ids == expected);
        CHECK(flat->nodes_tested == 0);
        CHECK(pipeline->occluders() == occluders);
        CHECK(&pipeline->world() == world);
        // Known ones are taken: another pipeline with none of them hides nothing.
        auto knows_none = Pipeline::create(yard.scene, {}, kWithOcclusion, serial_executor(),
                                           std::make_shared<const SceneOccluders>())
                              .value();
        CHECK(knows_none.run(Camera{})->occlusion->visible_ids == yard.all);
    }

    TEST_CASE("collisions switched off and on again are those of a new pipeline, and movers alone have them") {
        scene::Scene scene;
        const auto cube = scene.add_mesh(testing::cube_mesh(0.5f));
        for (int i = 0; i < 4; ++i)
            REQUIRE(scene.add_instance(*scene.add_node(scene::kNone, {glm::dmat3(1.0), {0.8 * i, 0.0, 0.0}}), *cube));
        scene.update();
        for (const BoundsKind kind : {BoundsKind::obb_perimeter, BoundsKind::aabb}) {
            auto pipeline = Pipeline::create(scene, {0, 1, 2}, {.bounds = kind}, serial_executor()).value();
            const auto before = pipeline.run(Camera{});
            CHECK(before->colliding_pairs == 2);
            REQUIRE(pipeline.set_options({.bounds = kind, .collide = false}).has_value());
            const auto off = pipeline.run(Camera{});
            CHECK(off->colliding_pairs == 0);
            CHECK(off->pairs_tested == 0);
            REQUIRE(pipeline.set_options({.bounds = kind}).has_value());
            const auto again = pipeline.run(Camera{});
            CHECK(again->colliding_ids == before->colliding_ids);
            CHECK(again->pairs_tested == before->pairs_tested);
        }
    }

    TEST_CASE("occluders that went through a file are the same, and hide the same") {
        Yard yard;
        const SceneOccluders found = find_scene_occluders(yard.scene, serial_executor());
        const bake::BakedOccluders baked = to_baked(found);
        const auto file = bake::bake(yard.scene, serial_executor(), {.occluders = &baked}).value();
        const auto loaded = bake::BakedScene::from_memory(file).value();
        REQUIRE(loaded.occluders().has_value());
        const SceneOccluders back = scene_occluders_from(yard.scene, *loaded.occluders());
        REQUIRE(back.objects.size() == found.objects.size());
        REQUIRE(back.kinds.size() == found.kinds.size());
        for (std::size_t k = 0; k < found.kinds.size(); ++k) {
            const auto &a = found.kinds[k].found.occluders, &b = back.kinds[k].found.occluders;
            REQUIRE(a.size() == b.size());
            for (std::size_t i = 0; i < a.size(); ++i) {
                CHECK(a[i].kind == b[i].kind);
                CHECK(a[i].surface.positions == b[i].surface.positions);
                CHECK(a[i].surface.indices == b[i].surface.indices);
                CHECK(a[i].box.center == b[i].box.center);
                CHECK(a[i].box.half_extents == b[i].box.half_extents);
                CHECK(a[i].eyes_within.min == b[i].eyes_within.min);
                CHECK(a[i].piece_bounds.max == b[i].piece_bounds.max);
                CHECK(a[i].edges == b[i].edges);
                CHECK(a[i].gain == b[i].gain);
            }
        }
        auto pipeline = Pipeline::create(yard.scene, {}, kWithOcclusion, serial_executor(),
                                         std::make_shared<const SceneOccluders>(back))
                            .value();
        CHECK(pipeline.run(Camera{})->occlusion->visible_ids == std::vector<std::uint32_t>{yard.wall, yard.beside});
    }

    TEST_CASE("meshes on one node are one occluding object, and what is not drawn is no part of it") {
        scene::Scene scene;
        const auto wall = scene.add_mesh(testing::box_mesh({-4.0f, -4.0f, -0.5f}, {4.0f, 4.0f, 0.5f})),
                   other = scene.add_mesh(testing::box_mesh({-0.5f, -4.0f, -4.0f}, {0.5f, 4.0f, 4.0f}));
        std::vector<scene::NodeId> nodes;
        for (int i = 0; i < 3; ++i) {
            nodes.push_back(*scene.add_node(scene::kNone, {glm::dmat3(1.0), {20.0 * i, 0.0, 0.0}}));
            REQUIRE(scene.add_instance(nodes.back(), *wall).has_value());
            const auto second = scene.add_instance(nodes.back(), *other);
            if (i == 2) REQUIRE(scene.set_instance_layers(*second, 0).has_value());
        }
        scene.update();
        const SceneOccluders occluders = find_scene_occluders(scene, serial_executor());
        REQUIRE(occluders.objects.size() == 3);
        REQUIRE(occluders.kinds.size() == 2);
        CHECK(occluders.objects[0].kind == occluders.objects[1].kind);
        CHECK(occluders.kinds[occluders.objects[0].kind].mesh.triangle_count() == 24);
        CHECK(occluders.kinds[occluders.objects[2].kind].mesh.triangle_count() == 12);
    }

    TEST_CASE("a right frame has no mismatch, and every kind of wrong occlusion has one") {
        Yard yard;
        auto pipeline = Pipeline::create(yard.scene, {}, kWithOcclusion, serial_executor()).value();
        const auto frame = pipeline.run(Camera{}).value();
        const std::vector<OwnerTriangle> owners{{yard.wall, 3}, {yard.wall, 4}, {yard.beside, 30}};
        std::vector<OwnerTriangle> more_owners = owners;
        more_owners.push_back({yard.behind[0], 40});
        const auto check = [&](const FrameStatistics& tampered, std::span<const OwnerTriangle> of_all,
                               std::uint64_t changed) {
            Verification verification;
            verify_occlusion(SceneDrawables(yard.scene), {of_all, owners}, changed, true, tampered, verification);
            return verification;
        };
        CHECK(check(frame, owners, 0).mismatches() == 0);
        CHECK(check(frame, more_owners, 0).hidden_but_seen == 1);
        CHECK(check(frame, std::span(owners).first(1), 0).hidden_but_seen == 2);
        CHECK(check(frame, owners, 7).changed_pictures == 1);
        CHECK(check(frame, owners, 7).changed_pixels == 7);
        FrameStatistics miscounted = frame;
        ++miscounted.occlusion->triangles_submitted;
        CHECK(check(miscounted, owners, 0).wrong_counts == 1);
        FrameStatistics more = frame;
        more.visible_ids.erase(more.visible_ids.begin());
        CHECK(check(more, owners, 0).wrong_verdicts == 1);
        FrameStatistics misdrawn = frame;
        misdrawn.occlusion->gpu = render::GpuCounters{24, 24, misdrawn.occlusion->triangles_clipped + 1, 0};
        CHECK(check(misdrawn, owners, 0).wrong_counts == 1);
    }

    TEST_CASE("the picture of owners names what is seen and nothing else") {
        Yard yard;
        render::DeviceOptions software;
        software.kind = render::DeviceKind::cpu;
        auto device = render::Device::create(software);
        if (!device) {
            MESSAGE("skipped: " << device.error().message);
            return;
        }
        DrawList list(yard.scene, {});
        auto rasterizer = render::Rasterizer::create(*device, {.width = 320, .height = 180}).value();
        REQUIRE(rasterizer.set_geometry(list.vertices(), list.indices()).has_value());
        OwnerPicture picture;
        list.select(yard.all, Camera{});
        REQUIRE(picture.draw(rasterizer, 0, list, Camera{}).has_value());
        CHECK(std::vector(picture.instances().begin(), picture.instances().end()) ==
              std::vector<scene::InstanceId>{yard.wall, yard.beside});
        const std::vector<OwnerTriangle> with_wall(picture.triangles().begin(), picture.triangles().end());
        // A box shows an eye at most three faces of two triangles.
        CHECK(with_wall.size() >= 4);
        CHECK(with_wall.size() <= 12);
        // What the wall hides can be left out: the same triangles own pixels, under the same numbers.
        const std::vector<scene::InstanceId> shown{yard.wall, yard.beside};
        list.select(shown, Camera{});
        REQUIRE(picture.draw(rasterizer, 0, list, Camera{}).has_value());
        CHECK(std::vector(picture.triangles().begin(), picture.triangles().end()) == with_wall);
        // Without the wall the others own pixels.
        std::vector<scene::InstanceId> rest = yard.all;
        rest.erase(std::find(rest.begin(), rest.end(), yard.wall));
        list.select(rest, Camera{});
        REQUIRE(picture.draw(rasterizer, 0, list, Camera{}).has_value());
        CHECK(std::vector(picture.instances().begin(), picture.instances().end()) == rest);
    }
}
