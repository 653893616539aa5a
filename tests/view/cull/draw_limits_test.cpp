// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <hwy/targets.h>
#include <algorithm>
#include <cmath>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <glm/common.hpp>
#include <oracle/aged_tree.hpp>
#include <type_traits>
#include <vector>

#include "../../ranges.hpp"
#include "limited_crowd.hpp"

using namespace crofton;
using crofton::testing::LimitedCrowd;
using crofton::testing::oracle_keeps;

TEST_SUITE("cull/draw_limits") {
    TEST_CASE("limits of a picture: a sphere at the limit has a diameter of as many pixels") {
        Camera camera;
        camera.position = {1.0, 2.0, 3.0};
        camera.fov_y = 1.0;
        const cull::DrawLimits limits = *cull::limits_of(camera, 1080.0, 4.0);
        CHECK(limits.eye == camera.position);
        // The outline of a sphere of radius 1 at distance d has half the angle asin(1 / d).
        const double pixels = 1080.0 * std::tan(std::asin(1.0 / limits.max_distance_in_radii)) / std::tan(0.5);
        CHECK(std::abs(pixels - 4.0) < 1e-9);
        camera.projection = Projection::orthographic;
        camera.height = 20.0;
        const cull::DrawLimits flat = *cull::limits_of(camera, 1000.0, 4.0);
        CHECK(flat.least_radius == doctest::Approx(0.04));  // 4 pixels of 0.02 are the diameter
        CHECK(!(flat.max_distance_in_radii < cull::DrawLimits::kNone));
        CHECK(!cull::limits_of(camera, 0.0, 4.0).has_value());
        CHECK(!cull::limits_of(camera, 1000.0, std::nan("")).has_value());
        camera.aspect = -1.0;
        CHECK(!cull::limits_of(camera, 1000.0, 4.0).has_value());
    }

    TEST_CASE("limits that are not finite drop nothing, and numbers without a unit are used unchanged") {
        const Obb box{.center = {10.0, 0.0, 0.0}, .half_extents = glm::vec3(1.0f)};
        Obb unknown = box;
        unknown.center.y = std::nan("");
        const float distances[1] = {std::nanf("")};
        CHECK(cull::is_worth_drawing({.max_distance_in_radii = 0.0}, unknown, 0));
        CHECK(cull::is_worth_drawing({.eye = {std::nan(""), 0.0, 0.0}, .max_distance_in_radii = 0.0}, box, 0));
        CHECK(cull::is_worth_drawing({.max_distance_in_radii = std::nan("")}, box, 0));
        CHECK(cull::is_worth_drawing({.least_radius = std::nan("")}, box, 0));
        CHECK(cull::is_worth_drawing({.item_distances = distances}, box, 0));
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        const float none[1] = {-std::numeric_limits<float>::infinity()};
        CHECK(cull::is_worth_drawing({.max_distance_in_radii = -kInfinity}, box, 0));
        CHECK(cull::is_worth_drawing({.max_distance_in_radii = -1e31}, box, 0));
        CHECK(cull::is_worth_drawing({.item_distances = none}, box, 0));
        CHECK(cull::is_worth_drawing({.layer_distances = std::vector<float>(32, none[0])}, box, 0));
        CHECK(cull::is_worth_drawing({.least_radius = 1.5}, box, 0));
        CHECK(!cull::is_worth_drawing({.least_radius = 1.75}, box, 0));
        CHECK(!cull::is_worth_drawing({.max_distance_in_radii = -1.0}, box, 0));
        CHECK(cull::is_worth_drawing({.max_distance_in_radii = 1e29}, box, 0));
        CHECK(!cull::is_worth_drawing(
            {.max_distance_in_radii = 5.0, .hysteresis = std::numeric_limits<double>::infinity()}, box, 0));
        const std::uint64_t drawn[1] = {1};
        CHECK(cull::is_worth_drawing({.max_distance_in_radii = 5.0,
                                      .drawn_before = drawn,
                                      .hysteresis = std::numeric_limits<double>::infinity()},
                                     box, 0));
    }

    TEST_CASE("on its limit an item is kept, one step of a double beyond it is not") {
        Obb box{.center = {0.0, 0.0, 15.0}, .half_extents = {1.0f, 2.0f, 2.0f}};  // radius 3
        CHECK(cull::is_worth_drawing({.max_distance_in_radii = 5.0}, box, 0));
        CHECK(cull::is_worth_drawing({.least_radius = 3.0}, box, 0));
        CHECK(!cull::is_worth_drawing({.least_radius = std::nextafter(3.0, 4.0)}, box, 0));
        CHECK(!cull::is_worth_drawing({.max_distance_in_radii = std::nextafter(5.0, 4.0)}, box, 0));
        box.center.z = std::nextafter(15.0, 16.0);
        CHECK(!cull::is_worth_drawing({.max_distance_in_radii = 5.0}, box, 0));
    }

    TEST_CASE("agrees with the oracle on items at their limits") {
        oracle::NearMisses random(3);
        int kept = 0;
        for (int trial = 0; trial < 20000; ++trial) {
            Obb box;
            box.half_extents = {float(random.number(0, 1)), float(random.number(0, 1)), random.index(2) ? 0.0f : 1.0f};
            const double radius = glm::length(glm::dvec3(box.half_extents));
            cull::DrawLimits limits;
            limits.eye = (trial % 2 ? 1e7 : 1.0) * random.direction();
            limits.max_distance_in_radii = random.number(0.0, 100.0);
            const double off = random.index(2) ? 0.0 : std::exp(random.number(-40.0, -1.0));
            box.center = limits.eye + (limits.max_distance_in_radii * radius * (1.0 + (random.index(2) ? off : -off))) *
                                          random.direction();
            const std::uint64_t drawn[1] = {random.index(2)};
            if (random.index(4) == 0) limits.hysteresis = 1.25;
            limits.drawn_before = drawn;
            if (random.index(4) == 0) limits.least_radius = radius;
            const bool keeps = cull::is_worth_drawing(limits, box, 0);
            kept += keeps;
            REQUIRE(keeps == oracle_keeps(limits, box, 0, 1));
        }
        CHECK(kept > 5000);
        CHECK(kept < 15000);
    }

    TEST_CASE("tree, list, moving boxes and a loop over all keep the same items, on every instruction set") {
        std::size_t some = 0;
        for (std::uint64_t seed = 0; seed < 24; ++seed) {
            const LimitedCrowd of(seed, seed % 2 ? 300 : 4000, seed % 4 == 3 ? 1e6 : 0.0);
            const std::vector<cull::ItemId> expected = of.expected();
            some += expected.size();
            boxtree::BoxTree tree = *boxtree::BoxTree::build(of.crowd.boxes, of.crowd.layers);
            std::vector<cull::ItemId> moving;
            std::vector<Obb> moving_boxes;
            for (cull::ItemId i = 0; i < of.crowd.boxes.size(); i += 3) {
                moving.push_back(i);
                moving_boxes.push_back(of.crowd.boxes[i]);
            }
            boxtree::BoxTree rest = *boxtree::BoxTree::build(of.crowd.boxes, of.crowd.layers, {.detached = moving});
            cull::MovingBoxes list;
            REQUIRE(list.update(rest, moving, moving_boxes).has_value());
            cull::VisibleSet visible;
            for (std::int64_t left = hwy::SupportedTargets(); left != 0; left &= left - 1) {
                hwy::SetSupportedTargetsForTest(left & -left);
                cull::find_visible(tree, of.view, visible, {.limits = &of.limits});
                REQUIRE(test::ranges::equal(visible.ids(), expected));
                for (std::size_t i = 0; i < visible.size(); ++i)
                    REQUIRE(visible.verdicts()[i] == cull::classify(of.view.frustum, of.crowd.boxes[visible.ids()[i]]));
                cull::find_visible(of.crowd.boxes, of.crowd.layers, of.view, visible, {.limits = &of.limits});
                REQUIRE(test::ranges::equal(visible.ids(), expected));
                cull::find_visible(rest, list, of.view, visible, {.limits = &of.limits});
                REQUIRE(test::ranges::equal(visible.ids(), expected));
                cull::find_visible(tree, of.view, visible,
                                   {cull::CullMode::exact, cull::ResultOrder::tree, &of.limits});
                CHECK(visible.size() == expected.size());
                hwy::SetSupportedTargetsForTest(0);
            }
        }
        CHECK(some > 1000);
    }

    TEST_CASE("many views in one pass keep what each keeps alone, of what rests and of what moves") {
        std::size_t some = 0;
        for (std::uint64_t seed = 0; seed < 24; ++seed) {
            const LimitedCrowd of(seed, seed % 2 ? 300 : 3000, seed % 4 == 3 ? 1e6 : 0.0);
            std::vector<cull::ItemId> moving;
            std::vector<Obb> moving_boxes;
            for (cull::ItemId i = 0; i < of.crowd.boxes.size(); i += 3) {
                moving.push_back(i);
                moving_boxes.push_back(of.crowd.boxes[i]);
            }
            const boxtree::BoxTree tree = *boxtree::BoxTree::build(of.crowd.boxes, of.crowd.layers),
                                   rest =
                                       *boxtree::BoxTree::build(of.crowd.boxes, of.crowd.layers, {.detached = moving});
            cull::MovingBoxes list;
            REQUIRE(list.update(rest, moving, moving_boxes).has_value());
            std::vector<cull::View> views{of.view, of.view, of.view};
            views[1].layer_mask = 5u;
            views[2].frustum.plane_count = 4;  // without near and far
            cull::VisibleSet one;
            cull::MaskedVisibleSet many[2];
            (void)cull::find_visible(tree, views, many[0], cull::CullMode::exact, &of.limits);
            (void)cull::find_visible(rest, list, views, many[1], cull::CullMode::exact, &of.limits);
            for (std::size_t v = 0; v < views.size(); ++v) {
                cull::find_visible(tree, views[v], one, {.limits = &of.limits});
                some += one.size();
                for (const cull::MaskedVisibleSet& all : many) {
                    std::vector<cull::ItemId> ids;
                    for (std::size_t i = 0; i < all.size(); ++i) {
                        REQUIRE(all.view_mask(i) != 0);
                        if (all.view_mask(i) >> v & 1) ids.push_back(all.ids()[i]);
                    }
                    test::ranges::sort(ids);
                    REQUIRE(test::ranges::equal(ids, one.ids()));
                }
            }
        }
        CHECK(some > 1000);
    }

    TEST_CASE("prepared lists keep what the definition keeps: boxes, aligned boxes and spheres, with any executor") {
        std::size_t kept = 0, dropped = 0;
        ThreadPool three(3);
        for (std::uint64_t seed = 0; seed < 12; ++seed) {
            const LimitedCrowd of(seed, seed % 2 ? 300 : 9000, seed % 4 == 3 ? 1e6 : 0.0);
            std::vector<Aabb> aligned;
            std::vector<Sphere> spheres;
            std::vector<Obb> of_aligned, of_spheres;  // of the same centre and size
            for (const Obb& box : of.crowd.boxes) {
                const glm::dvec3 corner = glm::round(box.center * 64.0) / 64.0;
                const glm::vec3 half = glm::ceil(box.half_extents * 64.0f) / 64.0f;
                aligned.push_back({corner - glm::dvec3(half), corner + glm::dvec3(half)});
                spheres.push_back({box.center, double(box.half_extents.x)});
                of_aligned.push_back({.center = corner, .half_extents = half});
                of_spheres.push_back({.center = box.center, .half_extents = {box.half_extents.x, 0.0f, 0.0f}});
            }
            const auto check = [&](const auto& bounds, const std::vector<Obb>& alike) {
                using Bound = typename std::decay_t<decltype(bounds)>::value_type;
                cull::BoundSet<Bound> set;
                set.assign(bounds);
                cull::VerdictBits all, few, same;
                cull::find_visible(set, bounds, of.view, all);
                cull::find_visible(set, bounds, of.view, of.limits, few);
                cull::find_visible(set, bounds, of.view, of.limits, same, cull::CullMode::exact, three);
                CHECK(test::ranges::equal(few.visible, same.visible));
                CHECK(test::ranges::equal(few.inside, same.inside));
                for (std::size_t w = 0; w < few.inside.size(); ++w) CHECK((few.inside[w] & ~few.visible[w]) == 0);
                for (std::uint32_t i = 0; i < bounds.size(); ++i) {
                    const bool keeps = oracle_keeps(of.limits, alike[i], i, of.view.layer_mask);
                    if (all.verdict(i) != cull::Verdict::outside) (keeps ? kept : dropped) += 1;
                    REQUIRE(few.verdict(i) == (keeps ? all.verdict(i) : cull::Verdict::outside));
                }
            };
            check(of.crowd.boxes, of.crowd.boxes);
            check(aligned, of_aligned);
            check(spheres, of_spheres);
        }
        CHECK(kept > 1000);
        CHECK(dropped > 1000);
    }

    TEST_CASE("a view that is not finite keeps to the limits, too") {
        LimitedCrowd of(1, 300, 0.0);
        of.view.frustum.planes[0].offset = std::nan("");
        const boxtree::BoxTree tree = *boxtree::BoxTree::build(of.crowd.boxes, of.crowd.layers);
        cull::VisibleSet visible;
        cull::find_visible(tree, of.view, visible, {.limits = &of.limits});
        CHECK(test::ranges::equal(visible.ids(), of.expected()));
    }

    TEST_CASE("far items are dropped by nodes, not item by item") {
        const oracle::Crowd crowd = oracle::random_crowd(20000, 0.0, 8);
        const boxtree::BoxTree tree = *boxtree::BoxTree::build(crowd.boxes);
        const std::vector<float> distances(32, 8.0f);
        const cull::DrawLimits limits{.layer_distances = distances};
        cull::VisibleSet visible;
        Camera camera;
        cull::find_visible(tree, {*frustum_of(camera)}, visible, {.limits = &limits});
        CHECK(visible.size() > 0);
        if (cull::kCountStatistics) CHECK(visible.statistics().boxes_tested < 5000);
    }

    TEST_CASE("small items are dropped by nodes, and large ones are kept by them") {
        const oracle::Crowd crowd = oracle::random_crowd(20000, 0.0, 9);
        std::vector<Obb> boxes = crowd.boxes;
        for (Obb& box : boxes) box.half_extents = glm::vec3(0.1f);
        const boxtree::BoxTree tree = *boxtree::BoxTree::build(boxes);
        const cull::View view{*frustum_of(Camera{})};
        cull::VisibleSet all, visible;
        cull::find_visible(tree, view, all);
        const auto tested = [&](const cull::DrawLimits& limits) {
            cull::find_visible(tree, view, visible, {.limits = &limits});
            return visible.statistics().boxes_tested;
        };
        if (!cull::kCountStatistics) return;
        CHECK(tested({.least_radius = 0.1}) == all.statistics().boxes_tested);
        CHECK(visible.size() == all.size());
        CHECK(tested({.max_distance_in_radii = 1e6}) == all.statistics().boxes_tested);
        CHECK(tested({.least_radius = 0.2}) == 0);
        CHECK(visible.size() == 0);
        CHECK(tested({.max_distance_in_radii = 50.0}) < 2000);
        CHECK(visible.size() > 0);
    }

    TEST_CASE("a tree that has lived keeps what a loop over its items keeps, on every instruction set") {
        std::size_t some = 0;
        for (std::uint64_t seed = 100; seed < 112; ++seed) {
            LimitedCrowd of(seed, seed % 2 ? 300 : 2000, 0.0);
            of.limits.item_distances = {};
            oracle::NearMisses random(seed);
            oracle::AgedTree aged(of.crowd);
            for (int age = 0; age < 5; ++age) {
                aged.live(random, age == 0 ? 3 : 300);
                REQUIRE(aged.tree.validate().has_value());
                std::vector<cull::ItemId> expected;
                for (cull::ItemId i = 0; i < aged.boxes.size(); ++i)
                    if (aged.holds(i) && aged.layers[i] & of.view.layer_mask &&
                        cull::classify(of.view.frustum, aged.boxes[i]) != cull::Verdict::outside &&
                        oracle_keeps(of.limits, aged.boxes[i], i, aged.layers[i] & of.view.layer_mask))
                        expected.push_back(i);
                some += expected.size();
                cull::VisibleSet visible;
                for (std::int64_t left = hwy::SupportedTargets(); left != 0; left &= left - 1) {
                    hwy::SetSupportedTargetsForTest(left & -left);
                    cull::find_visible(aged.tree, of.view, visible, {.limits = &of.limits});
                    REQUIRE(test::ranges::equal(visible.ids(), expected));
                    hwy::SetSupportedTargetsForTest(0);
                }
            }
        }
        CHECK(some > 300);
    }

    TEST_CASE("sizes and distances that floats cannot square are decided all the same") {
        std::vector<Obb> boxes;
        for (int i = 0; i < 400; ++i) {
            Obb box;
            box.half_extents = glm::vec3(std::ldexp(1.0f, i / 4 - 3 * (i % 40)));
            box.center = {0.0, 0.0, -std::ldexp(1.0, i / 4)};
            boxes.push_back(box);
        }
        const boxtree::BoxTree tree = *boxtree::BoxTree::build(boxes);
        Camera camera;
        camera.far_distance = 1e30;
        cull::View view{*frustum_of(camera)};
        view.frustum.plane_count = 5;
        for (const double radii : {1e-20, 0.5, 3.0, 1e3, 1e12, 1e25})
            for (const double least : {0.0, 1e-25, 1.0, 1e22}) {
                const cull::DrawLimits limits{.max_distance_in_radii = radii, .least_radius = least};
                std::vector<cull::ItemId> expected;
                for (cull::ItemId i = 0; i < boxes.size(); ++i)
                    if (cull::classify(view.frustum, boxes[i]) != cull::Verdict::outside &&
                        cull::is_worth_drawing(limits, boxes[i], i))
                        expected.push_back(i);
                cull::VisibleSet visible;
                cull::find_visible(tree, view, visible, {.limits = &limits});
                REQUIRE(test::ranges::equal(visible.ids(), expected));
            }
    }

    TEST_CASE("boxes whose squares floats cannot hold are dropped within their own size") {
        Camera camera;
        cull::View view{*frustum_of(camera)};
        view.frustum.plane_count = 5;
        std::size_t dropped = 0;
        for (const double radius : {1e19, 1.8e19, 1.9e19, 3e19, 1e25})
            for (const double distance : {0.3, 0.6, 0.75, 0.9, 1.1}) {
                const auto half = static_cast<float>(radius / std::sqrt(3.0));
                const std::vector<Obb> boxes{
                    {.center = {0.0, 0.0, -distance * radius}, .half_extents = glm::vec3(half)}};
                const boxtree::BoxTree tree = *boxtree::BoxTree::build(boxes);
                for (const double radii : {0.25, 0.5, 0.8, 1.0}) {
                    const cull::DrawLimits limits{.max_distance_in_radii = radii};
                    cull::VisibleSet visible;
                    cull::find_visible(tree, view, visible, {.limits = &limits});
                    CHECK(visible.size() == (cull::is_worth_drawing(limits, boxes[0], 0) ? 1 : 0));
                    dropped += visible.size() == 0;
                }
            }
        CHECK(dropped > 40);
    }

    TEST_CASE("from an eye beyond all coordinates nothing is dropped") {
        const std::vector<Obb> boxes(40, Obb{.center = {0.0, 0.0, -10.0}, .half_extents = glm::vec3(1.0f)});
        const boxtree::BoxTree tree = *boxtree::BoxTree::build(boxes);
        const cull::DrawLimits limits{.eye = {1e31, 0.0, 0.0}, .max_distance_in_radii = 2.0};
        cull::VisibleSet visible;
        cull::find_visible(tree, {*frustum_of(Camera{})}, visible, {.limits = &limits});
        CHECK(visible.size() == boxes.size());
    }

    TEST_CASE("with hysteresis an item at its limit comes and goes once, without it in every other frame") {
        const std::vector<Obb> boxes{{.center = {0.0, 0.0, -100.0}, .half_extents = glm::vec3(1.0f)}};
        for (const double longer : {1.0, 1.1}) {
            cull::DrawLimits limits{.hysteresis = longer};
            const float distance[1] = {100.0f};
            limits.item_distances = distance;
            cull::VisibleSet visible;
            Vector<std::uint64_t> drawn;
            int changes = 0;
            std::size_t before = 0;
            for (int frame = 0; frame < 20; ++frame) {
                limits.eye.z = frame % 2 ? -1.0 : 1.0;
                limits.drawn_before = drawn;
                cull::find_visible(boxes, {}, {*frustum_of(Camera{})}, visible, {.limits = &limits});
                changes += visible.size() != before;
                before = visible.size();
                cull::to_bits(visible.ids(), boxes.size(), drawn);
            }
            CHECK(changes == (longer > 1.0 ? 1 : 19));
        }
    }
}
