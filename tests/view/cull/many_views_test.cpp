// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <error_of.hpp>
#include <map>
#include <oracle/random_boxes.hpp>
#include <vector>

#include "../../ranges.hpp"

using namespace crofton;

namespace {

// One query per view, put together.
std::map<cull::ItemId, std::uint32_t> one_by_one(const boxtree::BoxTree& tree, std::span<const cull::View> views,
                                                 cull::CullMode mode) {
    std::map<cull::ItemId, std::uint32_t> masks;
    cull::VisibleSet visible;
    for (std::size_t v = 0; v < views.size(); ++v) {
        cull::find_visible(tree, views[v], visible, {mode});
        for (const cull::ItemId id : visible.ids()) masks[id] |= 1u << v;
    }
    return masks;
}

}  // namespace

TEST_SUITE("cull/many_views") {
    TEST_CASE("no views see nothing, a view that is not finite does not spoil the others") {
        const oracle::Crowd crowd = oracle::random_crowd(300, 0.0, 1);
        const auto tree = boxtree::BoxTree::build(crowd.boxes, crowd.layers);
        cull::MaskedVisibleSet visible;
        (void)cull::find_visible(*tree, std::span<const cull::View>{}, visible);
        CHECK(visible.size() == 0);
        std::vector<cull::View> views(3, cull::View{*frustum_of(Camera{}), 3u});
        views[1].frustum.planes[0].offset = std::nan("");
        (void)cull::find_visible(*tree, views, visible);
        const auto expected = one_by_one(*tree, views, cull::CullMode::exact);
        CHECK(visible.size() == expected.size());
        for (std::size_t i = 0; i < visible.size(); ++i) CHECK(expected.at(visible.ids()[i]) == visible.view_mask(i));
    }

    TEST_CASE("if all is visible, leaves that lack an item list nothing in its place") {
        const oracle::Crowd crowd = oracle::random_crowd(4096, 0.0, 7);
        cull::View everything{*frustum_of(Camera{})};
        everything.frustum.planes[0] = {{0.0, 0.0, 1.0}, 1e6};
        everything.frustum.plane_count = 1;
        const std::vector<cull::View> views(2, everything);
        cull::MaskedVisibleSet visible;
        // Leaves go to the kernel sixteen by sixteen: only in one of them something is missing.
        for (cull::ItemId removed = 5; removed < 4096; removed += 97) {
            auto tree = boxtree::BoxTree::build(crowd.boxes);
            REQUIRE(tree->remove(removed).has_value());
            (void)cull::find_visible(*tree, views, visible);
            std::vector<cull::ItemId> ids(visible.ids().begin(), visible.ids().end());
            std::sort(ids.begin(), ids.end());
            CAPTURE(removed);
            CHECK(ids.size() == 4095);
            CHECK(std::adjacent_find(ids.begin(), ids.end()) == ids.end());
            CHECK_FALSE(std::binary_search(ids.begin(), ids.end(), removed));
        }
    }

    TEST_CASE("a view of no layer sees nothing, of lists without layers as of trees") {
        const oracle::Crowd crowd = oracle::random_crowd(5000, 0.0, 6);
        const auto tree = boxtree::BoxTree::build(crowd.boxes);
        cull::BoxSet set;
        set.assign(crowd.boxes);
        std::vector<cull::View> views(3, cull::View{*frustum_of(Camera{})});
        views[1].layer_mask = 0;
        views[2].layer_mask = 0;
        views[2].frustum.plane_count = 0;  // vectors do not take it
        std::vector<std::uint32_t> masks(crowd.boxes.size());
        std::vector<cull::Statistics> statistics(views.size());
        (void)cull::find_visible(set, crowd.boxes, {}, views, masks, cull::CullMode::exact, serial_executor(),
                                 statistics);
        cull::VisibleSet visible;
        cull::find_visible(crowd.boxes, {}, views[0], visible);
        CHECK(visible.size() > 0);
        std::size_t seen = 0;
        for (const std::uint32_t mask : masks) {
            CHECK(mask <= 1);
            seen += mask;
        }
        CHECK(seen == visible.size());
        for (const cull::Statistics& of_view : statistics)
            CHECK(of_view.boxes_tested == (cull::kCountStatistics ? crowd.boxes.size() : 0));
        for (const auto& view : {views[1], views[2]}) {
            cull::find_visible(crowd.boxes, {}, view, visible);
            CHECK(visible.size() == 0);
            cull::find_visible(*tree, view, visible);
            CHECK(visible.size() == 0);
        }
    }

    TEST_CASE("33 views are refused by each query of one pass, which leaves its answer as it was") {
        const oracle::Crowd crowd = oracle::random_crowd(300, 0.0, 6);
        const auto tree = boxtree::BoxTree::build(crowd.boxes);
        REQUIRE(tree.has_value());
        cull::BoxSet set;
        set.assign(crowd.boxes);
        const std::vector<cull::View> views(33, cull::View{*frustum_of(Camera{})});
        const auto fit = std::span(views).first(32);
        std::vector<std::uint32_t> masks(crowd.boxes.size(), 7);
        cull::MaskedVisibleSet visible;
        const cull::MovingBoxes moving;
        REQUIRE(cull::find_visible(*tree, fit, visible).has_value());
        const std::size_t seen = visible.size();
        for (const Result<void>& asked :
             {cull::find_visible(*tree, views, visible), cull::find_visible(*tree, moving, views, visible),
              cull::find_visible(set, crowd.boxes, {}, views, masks)}) {
            const Error error = error_of(asked);
            CHECK(error.code == ErrorCode::out_of_range);
            CHECK(error.item == 32);
            CHECK(error.message.find("33 views") != std::string::npos);
        }
        CHECK(visible.size() == seen);
        CHECK(masks == std::vector<std::uint32_t>(masks.size(), 7));
        REQUIRE(cull::find_visible(set, crowd.boxes, {}, fit, masks).has_value());
        CHECK(std::count(masks.begin(), masks.end(), ~0u) == std::ptrdiff_t(seen));
    }

    TEST_CASE("a list of any length is shared among threads, with the same answer, order and statistics") {
        const oracle::Crowd crowd = oracle::random_crowd(70000, 0.0, 8);
        struct Counting : Executor {
            std::size_t calls = 0;
            [[nodiscard]] unsigned concurrency() const override { return 8; }
            void parallel_for(std::size_t count, std::size_t grain, RangeTask body) override {
                ++calls;  // backwards, as no thread is sure to be first
                for (std::size_t left = (count + grain - 1) / grain; left-- > 0;)
                    body(left * grain, std::min(count, (left + 1) * grain), 0);
            }
        };
        oracle::NearMisses random(5, 0.0);
        ThreadPool two(2), seven(7);
        cull::VisibleSet serial, threaded;
        for (const std::size_t size : {0u, 1u, 4095u, 16383u, 16384u, 16385u, 40001u, 70000u})
            for (unsigned choice = 0; choice < 8; ++choice) {
                const auto boxes = std::span(crowd.boxes).first(size);
                const auto layers = std::span(crowd.layers).first(choice & 1u ? size : 0);
                cull::View view{*frustum_of(random.camera()), 0x55u};
                if (choice == 7) view.frustum.planes[1].offset = std::nan("");
                cull::DrawLimits limits;
                limits.eye = view.frustum.origin;
                limits.max_distance_in_radii = 30.0;
                const std::vector<std::uint64_t> candidate_mask(300, 0x0ff0f0f0ff0f0f0fu);
                cull::CullOptions how{.mode = choice & 2u ? cull::CullMode::conservative : cull::CullMode::exact,
                                      .order = choice & 4u ? cull::ResultOrder::tree : cull::ResultOrder::ascending};
                if (choice % 3 == 1) how.limits = &limits;
                if (choice % 3 == 2) how.candidate_mask = candidate_mask;
                cull::find_visible(boxes, layers, view, serial, how);
                Counting counting;
                for (Executor* executor : {static_cast<Executor*>(&two), static_cast<Executor*>(&seven),
                                           static_cast<Executor*>(&counting)}) {
                    cull::find_visible(boxes, layers, view, threaded, how, *executor);
                    CHECK(test::ranges::equal(serial.ids(), threaded.ids()));
                    CHECK(test::ranges::equal(serial.verdicts(), threaded.verdicts()));
                    CHECK(serial.inside_count() == threaded.inside_count());
                    CHECK(serial.statistics().boxes_tested == threaded.statistics().boxes_tested);
                    CHECK(serial.statistics().straddling == threaded.statistics().straddling);
                    CHECK(serial.statistics().exact_tests == threaded.statistics().exact_tests);
                    CHECK(serial.statistics().false_positives == threaded.statistics().false_positives);
                }
                CHECK((counting.calls > 0) == (size >= 16384));
            }
    }

    TEST_CASE("a list for each view is what the view sees alone, with more threads than views and with fewer") {
        const oracle::Crowd crowd = oracle::random_crowd(3000, 0.0, 5);
        const auto tree = boxtree::BoxTree::build(crowd.boxes, crowd.layers);
        REQUIRE(tree.has_value());
        oracle::NearMisses random(3, 0.0);
        std::vector<cull::View> views;
        for (unsigned v = 0; v < 40; ++v) views.push_back({*frustum_of(random.camera()), v % 3 ? ~0u : 1u << (v % 5)});
        views[7].frustum.planes[0].offset = std::nan("");
        ThreadPool pool(3);
        std::vector<cull::VisibleSet> lists(views.size());
        cull::VisibleSet alone;
        std::size_t seen = 0;
        for (const std::size_t used : {40u, 2u, 0u})
            for (Executor* executor : {static_cast<Executor*>(&pool), &serial_executor()})
                for (const cull::ResultOrder order : {cull::ResultOrder::ascending, cull::ResultOrder::tree}) {
                    const auto some = std::span<const cull::View>(views).first(used);
                    const cull::CullOptions options{.order = order};
                    cull::find_visible(*tree, some, std::span(lists).first(used), options, *executor);
                    for (std::size_t v = 0; v < used; ++v) {
                        cull::find_visible(*tree, views[v], alone, options);
                        CHECK(test::ranges::equal(lists[v].ids(), alone.ids()));
                        CHECK(test::ranges::equal(lists[v].verdicts(), alone.verdicts()));
                        CHECK(lists[v].inside_count() == alone.inside_count());
                        seen += alone.size();
                    }
                }
        CHECK(seen > 1000);
    }

    TEST_CASE("32 views in one pass see what each sees alone: cameras, open volumes, shadow volumes, layers") {
        for (const double offset : {0.0, 1e7})
            for (const std::size_t count : {1u, 40u, 6000u}) {
                const oracle::Crowd crowd = oracle::random_crowd(count, offset, count);
                auto tree = boxtree::BoxTree::build(crowd.boxes, crowd.layers);
                REQUIRE(tree.has_value());
                oracle::NearMisses random(11, offset);
                // Some leaves no longer in one run, some half empty.
                for (std::uint32_t i = 0; i + 7 < count; i += 7) {
                    REQUIRE(tree->remove(i).has_value());
                    REQUIRE(tree->insert(crowd.boxes[i], crowd.layers[i]).has_value());
                }
                tree->refit();
                std::vector<cull::View> views;
                for (unsigned v = 0; v < 32; ++v) {
                    Camera camera = random.camera();
                    camera.far_distance = camera.near_distance + random.number(1.0, 60.0);
                    cull::View view{*frustum_of(camera), v % 4 ? ~0u : 1u << (v % 5)};
                    if (v % 5 == 1) view.frustum.plane_count = 5;
                    if (v % 5 == 2) view.frustum = *cull::shadow_volume(view.frustum, random.direction());
                    if (v % 5 == 3)
                        view.frustum =
                            *cull::shadow_volume_of_point(view.frustum, camera.position + 30.0 * random.direction());
                    views.push_back(view);
                }
                cull::MaskedVisibleSet visible;
                for (const cull::CullMode mode : {cull::CullMode::conservative, cull::CullMode::exact})
                    for (const std::size_t used : {32u, 12u, 4u}) {
                        const auto some = std::span<const cull::View>(views).first(used);
                        (void)cull::find_visible(*tree, some, visible, mode);
                        const auto expected = one_by_one(*tree, some, mode);
                        REQUIRE(visible.size() == expected.size());
                        for (std::size_t i = 0; i < visible.size(); ++i)
                            REQUIRE(expected.at(visible.ids()[i]) == visible.view_mask(i));
                    }
            }
    }
}

TEST_SUITE("cull/shadow_volume") {
    TEST_CASE("a light that is no direction, not finite or a view of too many planes is refused") {
        const Frustum view = *frustum_of(Camera{});
        CHECK(error_of(cull::shadow_volume(view, glm::dvec3(0.0))).code == ErrorCode::degenerate);
        CHECK(error_of(cull::shadow_volume(view, {std::nan(""), 0.0, 1.0})).code == ErrorCode::non_finite);
        CHECK(error_of(cull::shadow_volume(*cull::shadow_volume(view, {0.3, 1.0, 0.2}), {1.0, 0.0, 0.0})).code ==
              ErrorCode::invalid_argument);
    }

    TEST_CASE("a direction towards the light may have any length") {
        const Frustum view = *frustum_of(Camera{});
        const glm::dvec3 toward(0.375, 1.0, 0.25);
        const Frustum expected = *cull::shadow_volume(view, toward);
        REQUIRE(expected.plane_count > view.plane_count);
        for (const int exponent : {1, 160, 1020, -1, -160, -540, -1060}) {
            const auto volume = cull::shadow_volume(view, std::ldexp(1.0, exponent) * toward);
            CAPTURE(exponent);
            REQUIRE(volume.has_value());
            REQUIRE(volume->plane_count == expected.plane_count);
            for (std::uint32_t i = 0; i < expected.plane_count; ++i) {
                CHECK(volume->planes[i].normal == expected.planes[i].normal);
                CHECK(volume->planes[i].offset == expected.planes[i].offset);
            }
        }
    }

    TEST_CASE("a point belongs to the volume iff its way from the light meets the view") {
        oracle::NearMisses random(4);
        int inside = 0;
        for (int trial = 0; trial < 400; ++trial) {
            const Frustum view = *frustum_of(random.camera());
            const glm::dvec3 direction = random.direction(), light = view.origin + 40.0 * random.direction();
            const Frustum far_volume = *cull::shadow_volume(view, direction),
                          near_volume = *cull::shadow_volume_of_point(view, light);
            CHECK(far_volume.plane_count <= Frustum::kMaxPlanes);
            for (int n = 0; n < 50; ++n) {
                const glm::dvec3 point = view.origin + random.number(0.0, 40.0) * random.direction();
                // Along the light the planes are linear: the part of the way inside the view is an interval.
                const auto meets = [&](const glm::dvec3& step, double longest) {
                    double low = 0.0, high = longest;
                    for (const Plane& plane : view.view()) {
                        const double at = glm::dot(plane.normal, point - view.origin) + plane.offset,
                                     slope = glm::dot(plane.normal, step);
                        if (slope > 0.0) low = std::max(low, -at / slope);
                        if (slope < 0.0) high = std::min(high, -at / slope);
                        if (slope == 0.0 && at < 0.0) return -1.0;
                    }
                    return high - low;
                };
                const auto least = [&](const Frustum& volume) {
                    double value = 1e300;
                    for (const Plane& plane : volume.view())
                        value = std::min(value, glm::dot(plane.normal, point - volume.origin) + plane.offset);
                    return value;
                };
                const double through_far = meets(-direction, 1e9), through_near = meets(point - light, 1e9);
                if (std::abs(least(far_volume)) > 1e-9) CHECK((least(far_volume) > 0.0) == (through_far >= 0.0));
                if (std::abs(least(near_volume)) > 1e-9) CHECK((least(near_volume) > 0.0) == (through_near >= 0.0));
                inside += through_far >= 0.0;
            }
        }
        CHECK(inside > 1000);
    }
}
