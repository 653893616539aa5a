// SPDX-License-Identifier: MIT
// Views of trees whose inner bounds lie along turned axes: classify's verdicts, box by box.
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/cull/classify.hpp>
#include <crofton/cull/cull.hpp>
#include <oracle/aged_tree.hpp>
#include <oracle/turned_crowd.hpp>

#include "../../ranges.hpp"
#include "classified.hpp"

using namespace crofton;
using boxtree::Orientation;
using cull::CullMode;
using testing::Classified;

namespace {

cull::View view_near(oracle::NearMisses& random, const glm::dvec3& middle, double spread, int trial) {
    Camera camera = random.camera();
    camera.position = middle + spread * random.number(0.0, trial % 3 ? 1.0 : 2.5) * random.direction();
    camera.near_distance = 0.001 * spread;
    camera.far_distance = camera.near_distance + spread * random.number(0.1, 4.0);
    return {*frustum_of(camera), trial % 4 < 2 ? 1u << random.index(4) : ~0u};
}

}  // namespace

TEST_SUITE("cull/oriented trees") {
    TEST_CASE("a view of an oriented tree gets classify's verdicts, near and far from the origin, large and small") {
        oracle::NearMisses random(1);
        ThreadPool pool(3);
        for (const auto& [offset, spread] :
             std::vector<std::pair<double, double>>{{0.0, 40.0}, {1e4, 40.0}, {1e7, 40.0}, {0.0, 1e-5}, {0.0, 1e8}}) {
            const oracle::Crowd crowd = oracle::turned_crowd(3000, offset, 2, spread);
            const glm::dvec3 middle = offset * glm::dvec3(1.0, -0.7, 0.3);
            for (const Orientation orientation : {Orientation::oriented, Orientation::automatic}) {
                const auto tree = *boxtree::BoxTree::build(crowd.boxes, crowd.layers, {.orientation = orientation});
                REQUIRE(tree.structure().axes().size() > 1);
                for (int trial = 0; trial < 40; ++trial) {
                    const cull::View view = view_near(random, middle, spread, trial);
                    const CullMode mode = trial % 2 ? CullMode::exact : CullMode::conservative;
                    const Classified expected(crowd.boxes, crowd.layers, view, mode);
                    cull::VisibleSet visible;
                    cull::find_visible(tree, view, visible, {mode});
                    REQUIRE(expected.is_answer(visible));
                    const std::vector<cull::View> views{view, view_near(random, middle, spread, trial)};
                    cull::MaskedVisibleSet many;
                    (void)cull::find_visible(tree, views, many, mode);
                    REQUIRE(expected.are_ids_of_view(many, 0));
                }
            }
        }
    }

    TEST_CASE("threads share an oriented tree's query, and the answer is the same") {
        const oracle::Crowd crowd = oracle::turned_crowd(80000, 0.0, 3, 300.0);
        const auto tree = *boxtree::BoxTree::build(crowd.boxes, crowd.layers, {.orientation = Orientation::automatic});
        REQUIRE(tree.structure().axes().size() > 1);
        oracle::NearMisses random(4);
        ThreadPool pool(3);
        for (int trial = 0; trial < 10; ++trial) {
            const cull::View view = view_near(random, glm::dvec3(0.0), 300.0, trial);
            cull::VisibleSet one, shared;
            cull::find_visible(tree, view, one, {CullMode::exact, cull::ResultOrder::tree});
            cull::find_visible(tree, view, shared, {CullMode::exact, cull::ResultOrder::tree}, pool);
            CHECK(test::ranges::equal(one.ids(), shared.ids()));
        }
    }

    TEST_CASE("draw limits drop from an oriented tree what they drop from a list") {
        const oracle::Crowd crowd = oracle::turned_crowd(3000, 1e4, 5);
        const auto tree = *boxtree::BoxTree::build(crowd.boxes, crowd.layers, {.orientation = Orientation::oriented});
        oracle::NearMisses random(6);
        for (int trial = 0; trial < 30; ++trial) {
            const cull::View view = view_near(random, 1e4 * glm::dvec3(1.0, -0.7, 0.3), 40.0, trial);
            cull::DrawLimits limits;
            limits.eye = view.frustum.origin;
            std::vector<float> distances(32, 60.0f);
            for (std::size_t layer = 0; layer < 4; ++layer)
                distances[layer] = static_cast<float>(random.number(5.0, 60.0));
            limits.layer_distances = distances;
            cull::CullOptions options;
            options.limits = &limits;
            cull::VisibleSet from_tree, from_list;
            cull::find_visible(tree, view, from_tree, options);
            cull::find_visible(crowd.boxes, crowd.layers, view, from_list, options);
            CHECK(test::ranges::equal(from_tree.ids(), from_list.ids()));
        }
    }

    TEST_CASE("an oriented tree that has lived gives classify's verdicts, before and after its bounds are tight") {
        oracle::NearMisses random(7);
        for (const Orientation orientation : {Orientation::oriented, Orientation::automatic}) {
            oracle::AgedTree aged(oracle::turned_crowd(2000, 0.0, 8), 40.0, orientation);
            for (int frame = 0; frame < 40; ++frame) {
                aged.live(random, 60);
                const cull::View view = view_near(random, glm::dvec3(0.0), 40.0, frame);
                cull::VisibleSet visible;
                cull::find_visible(aged.tree, view, visible);
                REQUIRE(Classified(aged.boxes, aged.layers_in_tree(), view).is_answer(visible));
            }
        }
    }
}
