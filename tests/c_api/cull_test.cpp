// SPDX-License-Identifier: MIT
#include <crofton/cull/cull.hpp>
#include <limits>
#include <random>

#include "handles.hpp"

using namespace crofton::capi_test;

namespace {

std::vector<crofton_box> random_boxes(std::size_t count) {
    std::mt19937 random(5);
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
    std::vector<crofton_box> boxes;
    for (std::size_t i = 0; i < count; ++i)
        boxes.push_back(box_at(80.0 * uniform() - 40.0, 80.0 * uniform() - 40.0, -80.0 * uniform() + 20.0,
                               static_cast<float>(uniform())));
    return boxes;
}

crofton_camera default_camera() {
    crofton_camera camera = crofton_default_camera();
    return camera;
}

}  // namespace

TEST_SUITE("capi/cull") {
    TEST_CASE("wrong sizes, too many planes and bad boxes are refused") {
        auto boxes = random_boxes(3);
        const VisibleSet visible = make_visible_set();
        View view = default_view();
        const auto cull = [&] {
            return cull_boxes(boxes.data(), nullptr, boxes.size(), &view, nullptr, nullptr, visible.get());
        };
        view.frustum.size = 0;
        CHECK(cull() == CROFTON_WRONG_SIZE);
        view = default_view();
        view.frustum.plane_count = CROFTON_MAX_PLANES + 1;
        CHECK(cull() == CROFTON_OUT_OF_RANGE);
        view = default_view();
        crofton_view_request request = request_of(view);
        const auto ask = [&] { return crofton_view_boxes(boxes.data(), nullptr, 3, &request, nullptr, visible.get()); };
        const crofton_occlusion_options occlusion = crofton_default_occlusion_options();
        const crofton_picture_view picture = crofton_default_picture_view();
        const crofton_camera camera = crofton_default_camera();
        CHECK(ask() == CROFTON_OK);
        request.camera = &camera;
        CHECK(ask() == CROFTON_INVALID_ARGUMENT);
        request.volume = nullptr;
        CHECK(ask() == CROFTON_OK);
        request.occlusion = &occlusion;
        CHECK(ask() == CROFTON_UNSUPPORTED);
        CHECK(mentions(crofton_last_error(), "crofton_view_boxes: view: `occlusion`"));
        request.occlusion = nullptr;
        request.picture = &picture;
        CHECK(ask() == CROFTON_UNSUPPORTED);
        request.picture = nullptr;
        request.camera = nullptr;
        CHECK(ask() == CROFTON_INVALID_ARGUMENT);
        request.size = 0;
        CHECK(ask() == CROFTON_WRONG_SIZE);
        CHECK(cull_boxes(nullptr, nullptr, 3, &view, nullptr, nullptr, visible.get()) == CROFTON_INVALID_ARGUMENT);
        CHECK(cull_boxes(boxes.data(), nullptr, 3, &view, nullptr, nullptr, nullptr) == CROFTON_BAD_HANDLE);
        CHECK(cull_tree(nullptr, &view, nullptr, nullptr, visible.get()) == CROFTON_BAD_HANDLE);
        crofton_view_info info{};
        CHECK(crofton_view_result_get_view(visible.get(), 0, &info) == CROFTON_WRONG_SIZE);
        info.size = sizeof info;
        CHECK(crofton_view_result_get_view(visible.get(), 1, &info) == CROFTON_OUT_OF_RANGE);
        boxes[1].center[0] = std::numeric_limits<double>::quiet_NaN();
        crofton_tree* tree = nullptr;
        CHECK(crofton_tree_create(boxes.data(), nullptr, 3, nullptr, &tree) == CROFTON_NON_FINITE);
        CHECK(crofton_last_error_item() == 1);
        CHECK(tree == nullptr);
    }

    TEST_CASE("no boxes at all: nothing is seen") {
        crofton_tree* tree = nullptr;
        REQUIRE(crofton_tree_create(nullptr, nullptr, 0, nullptr, &tree) == CROFTON_OK);
        const Tree owner(tree);
        const VisibleSet visible = make_visible_set();
        const View view = default_view();
        REQUIRE(cull_tree(tree, &view, nullptr, nullptr, visible.get()) == CROFTON_OK);
        const uint32_t* ids = nullptr;
        std::size_t count = 1;
        REQUIRE(visible_set_items(visible.get(), &ids, nullptr, &count) == CROFTON_OK);
        CHECK(count == 0);
    }

    TEST_CASE("tree, list and single verdicts agree with C++") {
        const auto boxes = random_boxes(3000);
        std::vector<std::uint32_t> masks(boxes.size());
        for (std::size_t i = 0; i < masks.size(); ++i) masks[i] = 1u << (i % 3);
        View view = default_view();
        view.layer_mask = 5;
        crofton::cull::View same;
        same.frustum = *crofton::frustum_of(crofton::Camera{});
        same.layer_mask = 5;
        crofton::cull::VisibleSet expected;
        crofton::cull::find_visible(std::span(reinterpret_cast<const crofton::Obb*>(boxes.data()), boxes.size()), masks,
                                    same, expected);
        crofton_tree* tree = nullptr;
        REQUIRE(crofton_tree_create(boxes.data(), masks.data(), boxes.size(), nullptr, &tree) == CROFTON_OK);
        const Tree owner(tree);
        std::vector<uint8_t> verdicts(boxes.size());
        REQUIRE(crofton_classify(&view.frustum, boxes.data(), boxes.size(), verdicts.data()) == CROFTON_OK);
        const VisibleSet visible = make_visible_set();
        for (const bool use_tree : {false, true}) {
            REQUIRE((use_tree ? cull_tree(tree, &view, nullptr, nullptr, visible.get())
                              : cull_boxes(boxes.data(), masks.data(), boxes.size(), &view, nullptr, nullptr,
                                           visible.get())) == CROFTON_OK);
            const uint32_t* ids = nullptr;
            const uint8_t* kinds = nullptr;
            std::size_t count = 0;
            REQUIRE(visible_set_items(visible.get(), &ids, &kinds, &count) == CROFTON_OK);
            REQUIRE(count == expected.size());
            REQUIRE(count > 50);
            for (std::size_t i = 0; i < count; ++i) {
                CHECK(ids[i] == expected.ids()[i]);
                CHECK(kinds[i] == verdicts[ids[i]]);
            }
        }
        auto statistics = sized<crofton_view_info>();
        REQUIRE(crofton_view_result_get_view(visible.get(), 0, &statistics) == CROFTON_OK);
        CHECK((statistics.triangles == nullptr && statistics.occluded_ids == nullptr && statistics.depth_width == 0));
        if (crofton::cull::kCountStatistics) CHECK(statistics.nodes_tested > 0);
    }

    TEST_CASE("trees and lists leave out the same small and far items, and drawn ones stay longer") {
        const auto boxes = random_boxes(3000);
        const crofton_camera camera = default_camera();
        auto limits = sized<crofton_draw_limits>();
        REQUIRE(crofton_draw_limits_of_camera(&camera, 1080.0, 16.0, &limits) == CROFTON_OK);
        CHECK(limits.max_distance_in_radii > 0.0);
        std::vector<float> item_distances(boxes.size(), 60.0f), layer_distances(32, 50.0f);
        const std::vector<std::uint64_t> drawn_before(boxes.size() / 64, 0x5555555555555555u);
        limits.item_distances = item_distances.data();
        limits.item_count = item_distances.size();
        limits.layer_distances = layer_distances.data();
        limits.drawn_before = drawn_before.data();
        limits.drawn_word_count = drawn_before.size();
        limits.hysteresis = 1.25;
        crofton::cull::DrawLimits same = *crofton::cull::limits_of(crofton::Camera{}, 1080.0, 16.0);
        same.item_distances = item_distances;
        same.layer_distances = layer_distances;
        same.drawn_before = drawn_before;
        same.hysteresis = 1.25;

        const View view = default_view();
        std::vector<uint8_t> verdicts(boxes.size());
        REQUIRE(crofton_classify(&view.frustum, boxes.data(), boxes.size(), verdicts.data()) == CROFTON_OK);
        std::vector<std::uint32_t> expected;
        std::size_t in_view = 0;
        for (std::uint32_t i = 0; i < boxes.size(); ++i) {
            if (verdicts[i] == CROFTON_OUTSIDE) continue;
            ++in_view;
            const auto& box = reinterpret_cast<const crofton::Obb&>(boxes[i]);
            if (crofton::cull::is_worth_drawing(same, box, i)) expected.push_back(i);
        }
        REQUIRE(expected.size() > 50);
        REQUIRE(expected.size() + 50 < in_view);

        crofton_tree* tree = nullptr;
        REQUIRE(crofton_tree_create(boxes.data(), nullptr, boxes.size(), nullptr, &tree) == CROFTON_OK);
        const Tree owner(tree);
        const VisibleSet visible = make_visible_set();
        auto options = sized<crofton_view_request>();
        options.limits = &limits;
        const auto ask = [&](bool use_tree) {
            return use_tree ? cull_tree(tree, &view, &options, nullptr, visible.get())
                            : cull_boxes(boxes.data(), nullptr, boxes.size(), &view, &options, nullptr, visible.get());
        };
        const auto found = [&] {
            const uint32_t* ids = nullptr;
            std::size_t count = 0;
            REQUIRE(visible_set_items(visible.get(), &ids, nullptr, &count) == CROFTON_OK);
            return std::vector<std::uint32_t>(ids, ids + count);
        };
        for (const bool use_tree : {false, true}) {
            CAPTURE(use_tree);
            options.size = sizeof options;
            limits.hysteresis = 1.25;
            REQUIRE(ask(use_tree) == CROFTON_OK);
            CHECK(found() == expected);
            // A caller's older struct lacks the limits.
            options.size = offsetof(crofton_view_request, limits);
            REQUIRE(ask(use_tree) == CROFTON_OK);
            CHECK(found().size() == in_view);
            options.size = sizeof options;
            limits.hysteresis = 0.5;
            CHECK(ask(use_tree) == CROFTON_OUT_OF_RANGE);
        }
        // A World's objects are items of the limits by their index.
        limits.hysteresis = 1.25;
        const WorldHandle world = make_world();
        for (const crofton_box& box : boxes) {
            auto description = sized<crofton_object_description>();
            const crofton_bound bound = box_bound(box);
            description.bound = &bound;
            crofton_object object{};
            REQUIRE(crofton_world_add(world.get(), &description, &object) == CROFTON_OK);
        }
        REQUIRE(crofton_world_update(world.get(), nullptr) == CROFTON_OK);
        const ViewResultHandle objects = make_view_result();
        crofton_view_request request = request_of(view);
        request.limits = options.limits;
        REQUIRE(crofton_world_view(world.get(), &request, 1, nullptr, objects.get()) == CROFTON_OK);
        const uint32_t* ids = nullptr;
        std::size_t count = 0;
        REQUIRE(crofton_view_result_ids(objects.get(), &ids, &count, nullptr, nullptr) == CROFTON_OK);
        CHECK(std::vector<std::uint32_t>(ids, ids + count) == expected);
    }

    TEST_CASE("limits of a camera: bad cameras, sizes and structs are refused") {
        crofton_camera camera = default_camera();
        auto limits = sized<crofton_draw_limits>();
        CHECK(crofton_draw_limits_of_camera(nullptr, 1080.0, 2.0, &limits) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_draw_limits_of_camera(&camera, 1080.0, 2.0, nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_draw_limits_of_camera(&camera, 0.0, 2.0, &limits) != CROFTON_OK);
        camera.projection = CROFTON_ORTHOGRAPHIC;
        camera.height = 10.0;
        REQUIRE(crofton_draw_limits_of_camera(&camera, 1000.0, 2.0, &limits) == CROFTON_OK);
        CHECK(limits.max_distance_in_radii == 0.0);
        CHECK(limits.least_radius == doctest::Approx(0.01));
        limits.size = sizeof limits + 8;
        CHECK(crofton_draw_limits_of_camera(&camera, 1000.0, 2.0, &limits) == CROFTON_WRONG_SIZE);
    }

    TEST_CASE("a tree changes: items come, move and go, wrong ids and boxes change nothing") {
        const crofton_box seen = box_at(0, 0, -5), behind = box_at(0, 0, 50);
        const std::vector<crofton_box> boxes{seen, behind};
        crofton_tree* tree = nullptr;
        REQUIRE(crofton_tree_create(boxes.data(), nullptr, 2, nullptr, &tree) == CROFTON_OK);
        const Tree owner(tree);
        const VisibleSet visible = make_visible_set();
        const View view = default_view();
        const auto ids = [&] {
            REQUIRE(crofton_tree_refit(tree, 100) == CROFTON_OK);
            REQUIRE(cull_tree(tree, &view, nullptr, nullptr, visible.get()) == CROFTON_OK);
            const uint32_t* found = nullptr;
            std::size_t count = 0;
            REQUIRE(visible_set_items(visible.get(), &found, nullptr, &count) == CROFTON_OK);
            return std::vector<uint32_t>(found, found + count);
        };
        crofton_box bad = seen;
        bad.half_extents[0] = -1.0f;
        uint32_t item = 77;
        const uint32_t one = 1, nine = 9;
        CHECK(crofton_tree_move(tree, &nine, &seen, 1) != CROFTON_OK);
        CHECK(crofton_last_error_item() == 9);
        CHECK(crofton_tree_move(tree, &one, &bad, 1) != CROFTON_OK);
        CHECK(crofton_tree_move(tree, nullptr, &seen, 1) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_tree_insert(tree, &bad, 1, &item) != CROFTON_OK);
        CHECK(crofton_tree_insert(tree, nullptr, 1, &item) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_tree_remove(tree, 9) != CROFTON_OK);
        CHECK(crofton_tree_refit(nullptr, 0) == CROFTON_BAD_HANDLE);
        CHECK(item == 77);
        CHECK(ids() == std::vector<uint32_t>{0});
        CHECK(crofton_tree_move(tree, &one, &seen, 1) == CROFTON_OK);
        CHECK(ids() == std::vector<uint32_t>{0, 1});
        CHECK(crofton_tree_remove(tree, 0) == CROFTON_OK);
        CHECK(ids() == std::vector<uint32_t>{1});
        CHECK(crofton_tree_insert(tree, &seen, 1, &item) == CROFTON_OK);
        CHECK(item == 0);
        CHECK(ids() == std::vector<uint32_t>{0, 1});
        CHECK(crofton_tree_set_layer_mask(tree, 1, 0) == CROFTON_OK);
        CHECK(ids() == std::vector<uint32_t>{0});
    }
}
