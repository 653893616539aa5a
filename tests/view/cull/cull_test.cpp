// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <hwy/targets.h>
#include <algorithm>
#include <cmath>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/cull/cull.hpp>
#include <limits>
#include <oracle/near_misses.hpp>
#include <oracle/random_boxes.hpp>
#include <vector>

#include "../../ranges.hpp"

using namespace crofton;
using cull::Verdict;

TEST_SUITE("cull/cull") {
    TEST_CASE("nothing to cull gives nothing") {
        const auto tree = boxtree::BoxTree::build(std::span<const Obb>{});
        REQUIRE(tree.has_value());
        cull::VisibleSet visible;
        cull::find_visible(*tree, {*frustum_of(Camera{})}, visible);
        CHECK(visible.size() == 0);
        cull::find_visible(std::span<const Obb>{}, {}, {*frustum_of(Camera{})}, visible);
        CHECK(visible.size() == 0);
    }

    TEST_CASE("a view that is not finite sees everything in its layers") {
        const oracle::Crowd town = oracle::random_crowd(100, 0.0, 1);
        const auto tree = boxtree::BoxTree::build(town.boxes, town.layers);
        REQUIRE(tree.has_value());
        cull::View view{*frustum_of(Camera{}), 2u};
        view.frustum.planes[0].offset = std::nan("");
        cull::VisibleSet visible;
        cull::find_visible(*tree, view, visible);
        std::size_t expected = 0;
        for (const std::uint32_t mask : town.layers) expected += (mask & 2u) != 0;
        CHECK(visible.size() == expected);
        CHECK(std::count(visible.verdicts().begin(), visible.verdicts().end(), Verdict::straddling) ==
              std::ptrdiff_t(expected));
    }

    TEST_CASE("a hundred thousand identical boxes are all seen, or none") {
        Obb box;
        box.half_extents = glm::vec3(0.5f);
        const std::vector<Obb> boxes(100000, box);
        const auto tree = boxtree::BoxTree::build(boxes);
        REQUIRE(tree.has_value());
        cull::VisibleSet visible;
        Camera camera;
        camera.position = {0.0, 0.0, 5.0};
        cull::find_visible(*tree, {*frustum_of(camera)}, visible);
        CHECK(visible.size() == boxes.size());
        camera.forward = {0.0, 0.0, 1.0};
        cull::find_visible(*tree, {*frustum_of(camera)}, visible);
        CHECK(visible.size() == 0);
    }

    TEST_CASE("tree and list give classify's verdicts, sorted, at every offset and in every mode") {
        for (const double offset : {0.0, 1e5, 1e7})
            for (const std::size_t count : {1u, 17u, 3000u}) {
                const oracle::Crowd town = oracle::random_crowd(count, offset, count);
                const auto tree = boxtree::BoxTree::build(town.boxes, town.layers);
                REQUIRE(tree.has_value());
                oracle::NearMisses random(7, offset);
                cull::VisibleSet from_tree, from_list;
                for (int trial = 0; trial < 25; ++trial) {
                    Camera camera = random.camera();
                    camera.far_distance = camera.near_distance + random.number(1.0, 60.0);
                    const cull::View view{*frustum_of(camera), trial % 3 ? ~0u : 5u};
                    cull::CullOptions options;
                    options.mode = trial % 2 ? cull::CullMode::exact : cull::CullMode::conservative;
                    std::vector<cull::ItemId> ids;
                    std::vector<Verdict> verdicts;
                    for (std::size_t i = 0; i < count; ++i) {
                        const Verdict verdict = cull::classify(view.frustum, town.boxes[i], options.mode);
                        if (verdict == Verdict::outside || !(town.layers[i] & view.layer_mask)) continue;
                        ids.push_back(static_cast<cull::ItemId>(i));
                        verdicts.push_back(verdict);
                    }
                    cull::find_visible(*tree, view, from_tree, options);
                    cull::find_visible(town.boxes, town.layers, view, from_list, options);
                    for (const cull::VisibleSet* visible : {&from_tree, &from_list}) {
                        CHECK(test::ranges::equal(visible->ids(), ids));
                        CHECK(test::ranges::equal(visible->verdicts(), verdicts));
                    }
                    options.order = cull::ResultOrder::tree;
                    cull::find_visible(*tree, view, from_tree, options);
                    std::vector<cull::ItemId> sorted(from_tree.ids().begin(), from_tree.ids().end());
                    test::ranges::sort(sorted);
                    CHECK(sorted == ids);
                }
            }
    }

    TEST_CASE(
        "unprepared boxes get classify's verdicts on every instruction set, however near, skewed, large or wrong") {
        const double nan = std::nan("");
        for (const double offset : {0.0, 1e7, 3e28, 5e29}) {
            oracle::NearMisses random(29, offset);
            for (int trial = 0; trial < 12; ++trial) {
                const cull::View view{*frustum_of(random.camera()), trial % 3 ? ~0u : 5u};
                std::vector<Obb> boxes(trial == 0 ? 9000 : 700 + 13 * static_cast<std::size_t>(trial));
                std::vector<std::uint32_t> layers(boxes.size());
                for (std::size_t i = 0; i < boxes.size(); ++i) {
                    Obb& box = boxes[i] = random.box(view.frustum);
                    layers[i] = 1u << random.index(4);
                    const int axis = static_cast<int>(random.index(3)), part = static_cast<int>(random.index(3));
                    switch (random.index(40)) {
                        case 0:
                            box.axes[axis][part] *= 1.9f;
                            break;  // neither orthogonal nor of unit length
                        case 1:
                            box.axes[axis][part] = 2.5f;
                            break;  // beyond what any query takes
                        case 2:
                            box.half_extents *= -1.0f;
                            break;
                        case 3:
                            box.half_extents[axis] = 1e19f;
                            break;
                        case 4:
                            box.half_extents *= 1e-38f;
                            break;
                        case 5:
                            box.half_extents[axis] = std::numeric_limits<float>::infinity();
                            break;
                        case 6:
                            box.center[part] = nan;
                            break;
                        case 7:
                            box.axes[axis][part] = std::nanf("");
                            break;
                        case 8:
                            box.half_extents[axis] = std::nanf("");
                            break;
                        case 9:
                            box.center[part] = 1.5e30;
                            break;
                        case 10:
                            box.half_extents[axis] = 2e30f;
                            box.axes[axis] = glm::vec3(0.0f);
                            break;
                        case 11:
                            box.center = view.frustum.origin;
                            break;
                        case 12:
                            box.half_extents = glm::vec3(1e9f);
                            break;
                        default:
                            break;
                    }
                }
                for (const cull::CullMode mode : {cull::CullMode::exact, cull::CullMode::conservative}) {
                    std::vector<cull::ItemId> ids, inside, straddling;
                    std::vector<Verdict> verdicts;
                    for (std::size_t i = 0; i < boxes.size(); ++i) {
                        const Verdict verdict = cull::classify(view.frustum, boxes[i], mode);
                        if (verdict == Verdict::outside || !(layers[i] & view.layer_mask)) continue;
                        ids.push_back(static_cast<cull::ItemId>(i));
                        verdicts.push_back(verdict);
                        (verdict == Verdict::inside ? inside : straddling).push_back(ids.back());
                    }
                    inside.insert(inside.end(), straddling.begin(), straddling.end());
                    for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
                        hwy::SetSupportedTargetsForTest(rest & -rest);
                        CAPTURE(hwy::TargetName(rest & -rest));
                        cull::VisibleSet visible;
                        cull::find_visible(boxes, layers, view, visible, {mode});
                        CHECK(test::ranges::equal(visible.ids(), ids));
                        CHECK(test::ranges::equal(visible.verdicts(), verdicts));
                        CHECK(visible.inside_count() == ids.size() - straddling.size());
                        cull::find_visible(boxes, layers, view, visible, {mode, cull::ResultOrder::tree});
                        CHECK(test::ranges::equal(visible.ids(), inside));
                        CHECK(visible.verdicts().empty());
                    }
                    hwy::SetSupportedTargetsForTest(0);
                }
            }
        }
    }

    TEST_CASE("ascending ids and their verdicts are the tree's order sorted, however items are numbered") {
        std::vector<Obb> boxes = oracle::random_crowd(20000, 0.0, 5).boxes;
        Camera camera;
        camera.position = {0.0, 0.0, 20.0};
        camera.far_distance = 60.0;
        const cull::View view{*frustum_of(camera)};
        for (int numbering = 0; numbering < 2; ++numbering) {
            const auto tree = *boxtree::BoxTree::build(boxes);
            for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
                hwy::SetSupportedTargetsForTest(rest & -rest);
                cull::VisibleSet sorted, unsorted;
                cull::find_visible(tree, view, sorted);
                cull::find_visible(tree, view, unsorted, {cull::CullMode::exact, cull::ResultOrder::tree});
                std::vector<std::pair<cull::ItemId, Verdict>> expected;
                for (std::size_t i = 0; i < unsorted.size(); ++i)
                    expected.emplace_back(unsorted.ids()[i],
                                          i < unsorted.inside_count() ? Verdict::inside : Verdict::straddling);
                test::ranges::sort(expected);
                REQUIRE(sorted.size() == expected.size());
                CHECK(sorted.inside_count() == unsorted.inside_count());
                CHECK(expected.size() > 1000);
                for (std::size_t i = 0; i < expected.size(); ++i)
                    CHECK(std::pair(sorted.ids()[i], sorted.verdicts()[i]) == expected[i]);
            }
            hwy::SetSupportedTargetsForTest(0);
            std::vector<Obb> along_the_tree;
            for (const boxtree::ItemId item : tree.structure().slot_items())
                if (item != boxtree::kNone) along_the_tree.push_back(boxes[item]);
            boxes = along_the_tree;
        }
    }

    TEST_CASE("after any moves, insertions, removals and rebuilds a tree gives classify's verdicts") {
        // Boxes of every size, from points to 1e20, near and far: frames of nodes and leaves must give way.
        oracle::NearMisses random(17);
        std::vector<Obb> boxes = oracle::random_crowd(2000, 0.0, 12).boxes;
        boxtree::BoxTree tree = *boxtree::BoxTree::build(boxes);
        std::vector<char> present(boxes.size(), 1);
        cull::VisibleSet visible;
        std::vector<cull::ItemId> sorted, ids;
        for (int frame = 0; frame < 150; ++frame) {
            for (int change = 0; change < 40; ++change) {
                const cull::ItemId item = random.index(static_cast<unsigned>(boxes.size()));
                Obb box = oracle::random_box(random, glm::dvec3(0.0), frame % 5 ? 40.0 : 4e6);
                if (change == 0) box.half_extents *= frame % 7 ? 0.0f : 1e20f;
                if (change == 1) box.half_extents *= 1e-38f;
                if (change == 2) box.center *= 1e18;
                if (change % 8 == 3) {
                    CHECK(tree.remove(item).has_value() == (present[item] != 0));
                    present[item] = 0;
                } else if (change % 8 == 4) {
                    const cull::ItemId id = *tree.insert(box);
                    boxes.resize(std::max<std::size_t>(boxes.size(), id + 1));
                    present.resize(boxes.size());
                    boxes[id] = box;
                    present[id] = 1;
                } else if (present[item]) {
                    REQUIRE(tree.move(item, box).has_value());
                    boxes[item] = box;
                }
            }
            tree.refit();
            if (frame % 2) (void)tree.rebuild_step(3000);
            Camera camera = random.camera();
            camera.far_distance = camera.near_distance + random.number(1.0, 60.0);
            const cull::View view{*frustum_of(camera)};
            ids.clear();
            for (std::size_t i = 0; i < boxes.size(); ++i)
                if (present[i] && cull::classify(view.frustum, boxes[i]) != Verdict::outside)
                    ids.push_back(static_cast<cull::ItemId>(i));
            cull::find_visible(tree, view, visible);
            CHECK(test::ranges::equal(visible.ids(), ids));
            cull::find_visible(tree, view, visible, {cull::CullMode::exact, cull::ResultOrder::tree});
            sorted.assign(visible.ids().begin(), visible.ids().end());
            test::ranges::sort(sorted);
            CHECK(sorted == ids);
            const auto valid = tree.validate();
            INFO((valid ? std::string() : valid.error().message));
            REQUIRE(valid.has_value());
        }
    }
}
