// SPDX-License-Identifier: MIT
// Frames that allocate nothing, and occluders that come and go.
#include <doctest/doctest.h>
#include <box_mesh.hpp>
#include <counting_memory.hpp>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <error_of.hpp>
#include <oracle/occlusion_scenes.hpp>

using namespace crofton;
using namespace crofton::test;

TEST_SUITE("occlude/warm") {
    TEST_CASE("choosing, moving, drawing and asking allocate nothing once they have done as much") {
        testing::CountingMemory memory;
        {
            Random random(77);
            const OcclusionScene scene = random_scene(random, 0.0, 2000);
            occlude::OccluderSet set = set_of(scene.occluders);
            const TriangleMesh cube = testing::cube_mesh();
            const auto convex = set.add_convex(cube.positions).value();
            const auto mesh = set.add_mesh(cube).value();
            const auto surface = set.add_surface(cube, occlude::Sides::both).value();
            std::vector<occlude::OccluderId> moved;
            for (const auto shape : {convex, mesh, surface}) moved.push_back(set.place(shape, {}).value());
            occlude::OccluderCandidates candidates;
            for (const Obb& box : scene.occluders) (void)candidates.add(occlude::candidate_of(box)).value();
            auto tree = *boxtree::BoxTree::build(scene.objects);
            auto buffer = *occlude::OcclusionBuffer::create(scene.size);
            const auto view = *occlude::occlusion_view_of(scene.camera);
            cull::DrawLimits limits;
            limits.eye = scene.camera.position;
            limits.max_distance_in_radii = 500.0;
            occlude::OccluderChoice choice;
            occlude::VisibleSet from_tree, from_list;
            occlude::OcclusionBits bits;
            cull::BoxSet boxes;
            boxes.assign(scene.objects);
            std::vector<std::uint64_t> hidden((scene.objects.size() + 63) / 64);
            const auto frame = [&](int number) {
                occlude::choose_occluders(candidates, view, {.max_occluders = 8}, choice);
                buffer.draw(set, choice.ids, view);
                for (const auto id : moved)
                    REQUIRE(set.move(id, {glm::dmat3(1.0), point_in_view(random, scene.camera, 5.0)}).has_value());
                // Pieces of meshes take as much room as they cover: the same place in every other frame.
                for (const auto id : moved)
                    REQUIRE(
                        set.move(id, {glm::dmat3(1.0), scene.camera.position +
                                                           (8.0 + number % 2) * glm::normalize(scene.camera.forward)})
                            .has_value());
                buffer.draw(set, view);
                occlude::find_visible(tree, buffer, from_tree, {.limits = &limits});
                occlude::find_visible(scene.objects, {}, buffer, from_list);
                occlude::find_visible(boxes, scene.objects, buffer, bits);
                buffer.find_hidden(scene.objects, hidden);
            };
            for (int i = 0; i < 4; ++i) frame(i);
            const std::size_t before = memory.allocations();
            for (int i = 0; i < 6; ++i) frame(i);
            CHECK(memory.allocations() == before);
            CHECK(from_tree.statistics().items_hidden + from_tree.statistics().nodes_hidden > 0);
        }
        CHECK(memory.bytes_in_use() == 0);
    }

    TEST_CASE("a removed occluder hides nothing, and its id is reused") {
        occlude::OccluderSet set;
        const auto shape = set.add_mesh(testing::cube_mesh()).value();
        Obb small;
        small.half_extents = glm::vec3(0.5f);
        const Transform place{glm::dmat3(3.0), {0.0, 0.0, -10.0}};
        const auto first = set.place(shape, place).value(), second = set.place(small).value();
        auto buffer = *occlude::OcclusionBuffer::create();
        const auto view = *occlude::occlusion_view_of(Camera());
        Obb behind;
        behind.center.z = -30.0;
        behind.half_extents = glm::vec3(0.5f);
        buffer.draw(set, view);
        REQUIRE(buffer.hides(behind));
        CHECK(error_of(set.remove_shape(shape)).code == ErrorCode::invalid_argument);
        REQUIRE(set.remove(first).has_value());
        CHECK(error_of(set.remove(first)).code == ErrorCode::out_of_range);
        CHECK(error_of(set.move(first, place)).code == ErrorCode::out_of_range);
        CHECK(error_of(set.set_enabled(first, true)).code == ErrorCode::out_of_range);
        buffer.draw(set, view);
        CHECK_FALSE(buffer.hides(behind));
        CHECK(set.place(shape, place).value() == first);
        buffer.draw(set, view);
        CHECK(buffer.hides(behind));
        const std::vector<occlude::OccluderId> chosen = {second};
        buffer.draw(set, chosen, view);
        CHECK_FALSE(buffer.hides(behind));
        buffer.draw(set, std::span<const occlude::OccluderId>(), view);
        CHECK_FALSE(buffer.hides(behind));
        CHECK(buffer.count_covered() == 0);
        REQUIRE(set.remove(first).has_value());
        REQUIRE(set.remove_shape(shape).has_value());
        CHECK(error_of(set.remove_shape(shape)).code == ErrorCode::out_of_range);
        CHECK(error_of(set.place(shape, place)).code == ErrorCode::out_of_range);
        CHECK(set.add_convex(testing::cube_mesh().positions).value() == shape);
        CHECK(set.size() == 2);
    }

    TEST_CASE("a list with draw limits leaves out what is not worth drawing, and keeps the rest") {
        Random random(78);
        const OcclusionScene scene = random_scene(random, 1e5, 800);
        auto buffer = *occlude::OcclusionBuffer::create(scene.size);
        buffer.draw(set_of(scene.occluders), *occlude::occlusion_view_of(scene.camera));
        cull::DrawLimits limits;
        limits.eye = scene.camera.position;
        limits.max_distance_in_radii = 60.0;
        occlude::VisibleSet all, some;
        const auto tree = *boxtree::BoxTree::build(scene.objects);
        occlude::find_visible(tree, buffer, all);
        occlude::find_visible(tree, buffer, some, {.limits = &limits});
        std::vector<boxtree::ItemId> expected;
        for (const boxtree::ItemId id : all.ids())
            if (cull::is_worth_drawing(limits, scene.objects[id], id)) expected.push_back(id);
        CHECK(expected.size() < all.size());
        CHECK(!expected.empty());
        CHECK(std::vector<boxtree::ItemId>(some.ids().begin(), some.ids().end()) == expected);
    }
}
