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
#include "classified.hpp"

using namespace crofton;
using cull::Verdict;
using testing::Classified;

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
                    const Classified expected(town.boxes, town.layers, view, options.mode);
                    cull::find_visible(*tree, view, from_tree, options);
                    cull::find_visible(town.boxes, town.layers, view, from_list, options);
                    CHECK(expected.is_answer(from_tree));
                    CHECK(expected.is_answer(from_list));
                    options.order = cull::ResultOrder::tree;
                    cull::find_visible(*tree, view, from_tree, options);
                    CHECK(expected.are_ids(from_tree.ids()));
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
                    const Classified expected(boxes, layers, view, mode);
                    std::vector<cull::ItemId> inside_first = expected.ids;
                    std::stable_partition(inside_first.begin(), inside_first.end(), [&](cull::ItemId id) {
                        return cull::classify(view.frustum, boxes[id], mode) == Verdict::inside;
                    });
                    for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
                        hwy::SetSupportedTargetsForTest(rest & -rest);
                        CAPTURE(hwy::TargetName(rest & -rest));
                        cull::VisibleSet visible;
                        cull::find_visible(boxes, layers, view, visible, {mode});
                        CHECK(expected.is_answer(visible));
                        cull::find_visible(boxes, layers, view, visible, {mode, cull::ResultOrder::tree});
                        CHECK(test::ranges::equal(visible.ids(), inside_first));
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
}
