// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <oracle/occlusion_scenes.hpp>
#include <oracle/witness_rays.hpp>

using namespace crofton;
using namespace crofton::test;

namespace {

// Objects in rows behind and before some walls, far more than a node holds.
OcclusionScene crowd_behind_walls(Random& random, double offset) {
    OcclusionScene scene = random_scene(random, offset, 3000);
    for (int i = 0; i < 4; ++i) {
        Obb wall = box_at(random, point_in_view(random, scene.camera, 8.0 + i), 1.0, 5.0);
        scene.occluders.push_back(wall);
    }
    return scene;
}

// Its walls drawn, and its objects in three layers by turns.
struct LayeredCrowd {
    OcclusionScene scene;
    occlude::OcclusionBuffer buffer;
    std::vector<std::uint32_t> layers;
};
LayeredCrowd layered_crowd(Random& random) {
    OcclusionScene scene = crowd_behind_walls(random, 0.0);
    auto buffer = *occlude::OcclusionBuffer::create(scene.size);
    buffer.draw(set_of(scene.occluders), *occlude::occlusion_view_of(scene.camera));
    std::vector<std::uint32_t> layers(scene.objects.size());
    for (std::size_t i = 0; i < layers.size(); ++i) layers[i] = 1u << (i % 3);
    return {std::move(scene), std::move(buffer), std::move(layers)};
}

// Judges an answer against the frustum's, box by box: what is missing must be hidden, by rays and by the single test
// or a bound above it.
struct Judgement {
    std::size_t missing = 0, seen_by_a_witness = 0, not_hidden_alone = 0, strangers = 0;
};
Judgement judge(Random& random, const OcclusionScene& scene, const occlude::OcclusionBuffer& buffer,
                std::span<const boxtree::ItemId> ids, std::span<const Obb> boxes) {
    Judgement result;
    const Frustum& frustum = buffer.view().frustum;
    std::vector<bool> found(boxes.size(), false);
    for (const boxtree::ItemId id : ids) found[id] = true;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const bool visible = cull::classify(frustum, boxes[i]) != cull::Verdict::outside;
        result.strangers += found[i] && !visible;
        if (found[i] || !visible) continue;
        ++result.missing;
        result.not_hidden_alone += !buffer.hides(boxes[i]);
        for (int n = 0; n < 8; ++n) {
            const glm::dvec3 point = point_of(random, boxes[i]);
            result.seen_by_a_witness +=
                is_in_view(frustum, point) && oracle::is_free(ray_to(scene.camera, point), scene.occluders);
        }
    }
    return result;
}

}  // namespace

TEST_SUITE("occlude/find_visible") {
    TEST_CASE(
        "what a query counts: every node and item of a crowd in the picture, the root's children of one beside it") {
        Random random(77);
        Camera camera;
        std::vector<Obb> boxes(3000);
        std::vector<std::uint32_t> layers(boxes.size());
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            boxes[i].center = {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-11.0, -9.0)};
            boxes[i].half_extents = glm::vec3(0.01f);
            layers[i] = 1u << i % 3;
        }
        auto buffer = *occlude::OcclusionBuffer::create({160, 90});
        buffer.draw(occlude::OccluderSet(), *occlude::occlusion_view_of(camera));
        occlude::VisibleSet visible;
        const auto count = [&](const boxtree::BoxTree& tree, const occlude::VisibleOptions& options) {
            occlude::find_visible(tree, buffer, visible, options);
            return visible.statistics();
        };
        const auto tree = *boxtree::BoxTree::build(boxes, layers);
        const std::size_t below_root = tree.structure().nodes().size() + tree.structure().leaves().size() - 1;
        const occlude::VisibleStatistics all = count(tree, {});
        CHECK(all.items_tested == boxes.size());
        CHECK(all.nodes_tested == below_root);
        CHECK(all.nodes_outside == 0);
        CHECK(all.nodes_hidden + all.items_hidden == 0);
        const occlude::VisibleStatistics one_layer = count(tree, {.layer_mask = 2});
        CHECK(one_layer.items_tested == 1000);
        CHECK(one_layer.nodes_outside == 0);
        for (const glm::dvec3& aside : {glm::dvec3(500, 0, 0), {0, -500, 0}, {0, 0, 500}}) {
            std::vector<Obb> beside = boxes;
            for (Obb& box : beside) box.center += aside;
            const auto other = *boxtree::BoxTree::build(beside, layers);
            const occlude::VisibleStatistics none = count(other, {});
            CHECK(visible.size() == 0);
            CHECK(none.items_tested == 0);
            CHECK(none.nodes_tested > 0);
            CHECK(none.nodes_outside == none.nodes_tested);
            CHECK(none.nodes_tested <= boxtree::kWidth);  // the root's children
        }
    }

    TEST_CASE("of a list each item is tested, and those are hidden that the buffer hides") {
        Random random(79);
        std::vector<Obb> boxes(2000);
        for (Obb& box : boxes) {
            box.center = {random.uniform(-6.0, 6.0), random.uniform(-6.0, 6.0), random.uniform(-12.0, -2.0)};
            box.half_extents = glm::vec3(0.05f);
        }
        occlude::OccluderSet walls;
        Obb wall;
        wall.center = {0.5, 0.0, -4.0};
        wall.half_extents = {1.0f, 1.0f, 0.1f};
        REQUIRE(walls.place(wall).has_value());
        auto buffer = *occlude::OcclusionBuffer::create({160, 90});
        buffer.draw(walls, *occlude::occlusion_view_of(Camera{}));
        CHECK(buffer.statistics().pieces_drawn == 1);
        CHECK(buffer.statistics().triangles_drawn == 0);
        occlude::VisibleSet visible;
        occlude::find_visible(boxes, {}, buffer, visible);
        std::uint64_t hidden = 0;
        for (const Obb& box : boxes) hidden += buffer.hides(box) ? 1 : 0;
        CHECK(hidden > 50);
        CHECK(visible.statistics().items_tested == boxes.size());
        CHECK(visible.statistics().items_hidden == hidden);
    }

    TEST_CASE("w of every point in a view is above its least_w, which is no less than half of w on the near plane") {
        Random random(78);
        for (int round = 0; round < 200; ++round) {
            Camera camera;
            camera.near_distance = std::exp(random.uniform(-5.0, 3.0));
            camera.far_distance = camera.near_distance * std::exp(random.uniform(0.5, 9.0));
            camera.fov_y = random.uniform(0.1, 2.5);
            camera.aspect = random.uniform(0.3, 3.0);
            camera.position = 1e3 * glm::dvec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
            const auto by_camera = *occlude::occlusion_view_of(camera);
            const auto by_matrix = *occlude::occlusion_view_of(world_to_clip(camera), DepthRange::reversed_zero_to_one);
            for (const occlude::OcclusionView& view : {by_camera, by_matrix}) {
                double least = 1e300;
                for (int k = 0; k < 100; ++k) {
                    const glm::dvec3 point = point_in_view(
                        random, camera,
                        std::exp(random.uniform(std::log(camera.near_distance), std::log(camera.far_distance))));
                    if (!is_in_view(view.frustum, point)) continue;
                    const glm::dvec3 p = point - view.origin;
                    const auto& row = view.rows[2];
                    least = std::min(least, row[0] * p.x + row[1] * p.y + row[2] * p.z + row[3]);
                }
                CHECK(view.least_w < least);
                CHECK(view.least_w >= (0.5 - 1e-6) * camera.near_distance);
                CHECK(view.least_w <= camera.near_distance);
            }
        }
    }

    TEST_CASE("trees, lists and what moves leave out only what is hidden") {
        Random random(5);
        std::size_t missing = 0, not_alone = 0;
        occlude::VisibleSet from_tree, from_list, from_both;
        for (const double offset : {0.0, 1e5, 1e7})
            for (int trial = 0; trial < 6; ++trial) {
                const OcclusionScene scene = crowd_behind_walls(random, offset);
                const auto set = set_of(scene.occluders);
                auto buffer = *occlude::OcclusionBuffer::create(scene.size);
                buffer.draw(set, *occlude::occlusion_view_of(scene.camera));
                auto tree = *boxtree::BoxTree::build(scene.objects);
                occlude::find_visible(tree, buffer, from_tree);
                const Judgement j = judge(random, scene, buffer, from_tree.ids(), scene.objects);
                CHECK(j.seen_by_a_witness == 0);
                CHECK(j.strangers == 0);
                missing += j.missing;
                not_alone += j.not_hidden_alone;
                CHECK(std::is_sorted(from_tree.ids().begin(), from_tree.ids().end()));
                // The list has no bounds above its boxes: it leaves out what the single test hides.
                occlude::find_visible(scene.objects, {}, buffer, from_list);
                const Judgement l = judge(random, scene, buffer, from_list.ids(), scene.objects);
                CHECK(l.seen_by_a_witness == 0);
                CHECK(l.strangers == 0);
                CHECK(l.not_hidden_alone == 0);
                CHECK(std::includes(from_list.ids().begin(), from_list.ids().end(), from_tree.ids().begin(),
                                    from_tree.ids().end()));
                cull::BoxSet boxes;
                boxes.assign(scene.objects);
                occlude::OcclusionBits bits;
                occlude::find_visible(boxes, scene.objects, buffer, bits);
                for (std::size_t i = 0; i < scene.objects.size(); ++i) {
                    const bool listed = std::binary_search(from_list.ids().begin(), from_list.ids().end(), i);
                    const occlude::Verdict verdict = bits.verdict(i);
                    CHECK(listed == (verdict == occlude::Verdict::inside || verdict == occlude::Verdict::straddling));
                    if (listed) continue;
                    CHECK((verdict == occlude::Verdict::outside) ==
                          (cull::classify(buffer.view().frustum, scene.objects[i]) == cull::Verdict::outside));
                }
                // A third of them moves.
                std::vector<boxtree::ItemId> items;
                std::vector<Obb> moved;
                for (std::uint32_t i = 0; i < scene.objects.size(); i += 3) {
                    (void)tree.detach(i);
                    items.push_back(i);
                    moved.push_back(scene.objects[i]);
                }
                tree.refit();
                cull::MovingBoxes moving;
                CHECK(moving.update(tree, items, moved));
                occlude::find_visible(tree, moving, buffer, from_both);
                const Judgement b = judge(random, scene, buffer, from_both.ids(), scene.objects);
                CHECK(b.seen_by_a_witness == 0);
                CHECK(b.strangers == 0);
                CHECK(std::includes(from_list.ids().begin(), from_list.ids().end(), from_both.ids().begin(),
                                    from_both.ids().end()));
            }
        MESSAGE(missing << " hidden, " << not_alone << " of them by a bound alone");
        CHECK(missing > 2'000);
    }

    TEST_CASE("verdicts are the frustum's, and layers are looked at") {
        Random random(6);
        const auto [scene, buffer, layers] = layered_crowd(random);
        const auto tree = *boxtree::BoxTree::build(scene.objects, layers);
        occlude::VisibleSet all, some;
        occlude::find_visible(tree, buffer, all);
        occlude::find_visible(tree, buffer, some, {.layer_mask = 2});
        std::size_t in_layer = 0;
        for (std::size_t n = 0; n < all.size(); ++n) {
            CHECK(all.verdicts()[n] == cull::classify(buffer.view().frustum, scene.objects[all.ids()[n]]));
            in_layer += all.ids()[n] % 3 == 1;
        }
        for (const boxtree::ItemId id : some.ids()) CHECK(id % 3 == 1);
        CHECK(some.size() == in_layer);
        CHECK(all.statistics().nodes_tested > 0);
    }

    TEST_CASE("a view of no layer sees nothing, of a list without layers as of a tree") {
        Random random(9);
        const auto [scene, buffer, layers] = layered_crowd(random);
        occlude::VisibleSet visible;
        occlude::find_visible(scene.objects, {}, buffer, visible);
        CHECK(visible.size() > 0);
        occlude::find_visible(scene.objects, {}, buffer, visible, {.layer_mask = 0});
        CHECK(visible.size() == 0);
        occlude::find_visible(*boxtree::BoxTree::build(scene.objects), buffer, visible, {.layer_mask = 0});
        CHECK(visible.size() == 0);
    }

    TEST_CASE("trees, lists and moving items return only items in the layers and the candidate mask") {
        Random random(8);
        const auto [scene, buffer, layers] = layered_crowd(random);
        // Whole leaves may not be seen, and of others some.
        std::vector<std::uint64_t> candidate_mask((scene.objects.size() + 63) / 64, 0);
        for (std::size_t i = 0; i < scene.objects.size(); ++i)
            if (scene.objects[i].center.x > scene.camera.position.x && i % 5 != 0)
                candidate_mask[i / 64] |= 1ull << (i % 64);
        const auto wanted = [&](const occlude::VisibleSet& from, bool by_layer, bool by_list) {
            std::vector<boxtree::ItemId> result;
            for (const boxtree::ItemId id : from.ids())
                if ((!by_layer || id % 3 == 1) && (!by_list || ((candidate_mask[id / 64] >> (id % 64)) & 1) != 0))
                    result.push_back(id);
            return result;
        };
        const auto ids = [](const occlude::VisibleSet& from) {
            return std::vector<boxtree::ItemId>(from.ids().begin(), from.ids().end());
        };
        auto tree = *boxtree::BoxTree::build(scene.objects, layers);
        occlude::VisibleSet all, some;
        occlude::find_visible(tree, buffer, all);
        occlude::find_visible(tree, buffer, some, {.candidate_mask = candidate_mask});
        CHECK(ids(some) == wanted(all, false, true));
        CHECK(some.size() < all.size());
        occlude::find_visible(scene.objects, layers, buffer, all);
        occlude::find_visible(scene.objects, layers, buffer, some, {.layer_mask = 2});
        CHECK(ids(some) == wanted(all, true, false));
        occlude::find_visible(scene.objects, layers, buffer, some, {.layer_mask = 2, .candidate_mask = candidate_mask});
        CHECK(ids(some) == wanted(all, true, true));
        std::vector<boxtree::ItemId> items;
        for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
            (void)tree.detach(i);
            items.push_back(i);
        }
        tree.refit();
        cull::MovingBoxes moving;
        REQUIRE(moving.update(tree, items, scene.objects));
        occlude::find_visible(tree, moving, buffer, all);
        occlude::find_visible(tree, moving, buffer, some, {.layer_mask = 2});
        CHECK(some.size() > 0);
        CHECK(ids(some) == wanted(all, true, false));
    }
}
