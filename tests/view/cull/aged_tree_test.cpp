// SPDX-License-Identifier: MIT
// Views of trees that have lived.
#include <doctest/doctest.h>
#include <algorithm>
#include <counting_memory.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/cull/cull.hpp>
#include <guarded_memory.hpp>
#include <oracle/aged_tree.hpp>
#include <set>

#include "../../ranges.hpp"
#include "classified.hpp"

using namespace crofton;
using cull::CullMode;
using cull::Verdict;
using oracle::AgedTree;

namespace {

cull::View view_of(oracle::NearMisses& random, int trial) {
    Camera camera = random.camera();
    // From a glance at a few to all at once.
    if (trial % 3 == 0) camera.position = 90.0 * random.direction();
    if (trial % 3 == 0) camera.forward = -camera.position;
    camera.far_distance = camera.near_distance + random.number(1.0, trial % 3 ? 60.0 : 300.0);
    return {*frustum_of(camera), trial % 4 < 2 ? 1u << random.index(4) : ~0u};
}

void check_view(const AgedTree& aged, const cull::View& view, CullMode mode, Executor& executor) {
    const testing::Classified expected(aged.boxes, aged.layers_in_tree(), view, mode);
    cull::VisibleSet visible;
    cull::find_visible(aged.tree, view, visible, {mode}, executor);
    REQUIRE(expected.is_answer(visible));
    cull::find_visible(aged.tree, view, visible, {mode, cull::ResultOrder::tree}, executor);
    REQUIRE(expected.are_ids(visible.ids()));
    REQUIRE(visible.inside_count() == expected.inside_count());
    const std::vector<cull::View> views{view, {view.frustum, ~view.layer_mask}};
    cull::MaskedVisibleSet many;
    (void)cull::find_visible(aged.tree, views, many, mode);
    REQUIRE(expected.are_ids_of_view(many, 0));
}

// What the counts must be, whatever the order of the walk.
void check_statistics(const AgedTree& aged, const cull::View& view, CullMode mode) {
    if (!cull::kCountStatistics) return;
    cull::VisibleSet visible;
    cull::find_visible(aged.tree, view, visible, {mode});
    const cull::Statistics& counted = visible.statistics();
    std::size_t in_tree = 0, inside = 0, false_positives = 0, straddling = 0;
    for (std::size_t i = 0; i < aged.boxes.size(); ++i) {
        if (!aged.holds(i)) continue;
        ++in_tree;
        const Verdict verdict = cull::classify(view.frustum, aged.boxes[i], mode);
        inside += verdict == Verdict::inside;
        straddling += verdict == Verdict::straddling;
        false_positives += verdict == Verdict::outside &&
                           cull::classify(view.frustum, aged.boxes[i], CullMode::conservative) != Verdict::outside;
    }
    CHECK(counted.straddling == straddling);
    CHECK(counted.false_positives == false_positives);
    CHECK(counted.accepted_whole <= inside);
    // Every item is accepted as a whole, tested, or below a bound that was rejected.
    CHECK(counted.accepted_whole + counted.boxes_tested <= in_tree);
    CHECK(counted.accepted_whole + counted.boxes_tested >= inside + straddling + false_positives);
    CHECK(counted.exact_tests <= counted.boxes_tested);
    // Whoever tests a box has tested the bound of its leaf.
    CHECK(counted.nodes_tested * boxtree::kWidth >= counted.boxes_tested + counted.accepted_whole);
    std::size_t bounds = 0;
    for (const boxtree::Node& node : aged.tree.structure().nodes()) bounds += node.count;
    CHECK(counted.nodes_tested <= bounds);
    CHECK(counted.nodes_tested >= aged.tree.structure().nodes()[0].count);
}

}  // namespace

TEST_SUITE("cull/aged trees") {
    TEST_CASE("trees of every age give classify's verdicts, in every order and for several views at once") {
        for (const std::size_t count : {std::size_t{600}, std::size_t{4000}}) {
            oracle::NearMisses random(31);
            oracle::for_each_age(count, count, [&](const AgedTree& aged) {
                for (int trial = 0; trial < 24; ++trial)
                    check_view(aged, view_of(random, trial), trial % 2 ? CullMode::exact : CullMode::conservative,
                               serial_executor());
            });
        }
    }

    TEST_CASE("after any changes to boxes of every size, from points to 1e20, a tree gives classify's verdicts") {
        // Frames of nodes and leaves must give way.
        oracle::NearMisses random(17);
        AgedTree aged(oracle::random_crowd(2000, 0.0, 12));
        aged.sizes = AgedTree::Sizes::any;
        for (int frame = 0; frame < 150; ++frame) {
            aged.spread = frame % 5 ? 40.0 : 4e6;
            aged.live(random, 40);
            if (frame % 2) (void)aged.tree.rebuild_step(3000);
            check_view(aged, view_of(random, frame), CullMode::exact, serial_executor());
            REQUIRE(aged.tree.validate().has_value());
        }
    }

    TEST_CASE("the counts of a query are those of the boxes, in trees of every age") {
        oracle::NearMisses random(32);
        oracle::for_each_age(33, 2000, [&](const AgedTree& aged) {
            for (int trial = 0; trial < 20; ++trial) {
                cull::View view = view_of(random, trial);
                view.layer_mask = ~0u;
                check_statistics(aged, view, CullMode::exact);
            }
        });
    }

    TEST_CASE("a great tree that has lived gives the same answers to several threads") {
        ThreadPool pool(3);
        oracle::NearMisses random(34);
        AgedTree aged(oracle::random_crowd(60000, 0.0, 35));
        while (aged.tree.item_count() < 70000) aged.insert(random, glm::dvec3(0.0));
        for (int trial = 0; trial < 9; ++trial) {
            cull::View view = view_of(random, trial);
            check_view(aged, view, CullMode::exact, pool);
            view.layer_mask = ~0u;
            check_statistics(aged, view, CullMode::exact);
            if (trial % 3 == 2) aged.live(random, 3000);
            while (aged.tree.item_count() < 66000) aged.insert(random, glm::dvec3(0.0));
        }
    }

    TEST_CASE("several threads query a large tree of undecided boxes within the memory that they have") {
        testing::GuardedMemory memory;
        {
            ThreadPool pool(3);
            oracle::NearMisses random(36);
            // A sheet on a plane, in heaps: leaves are not full.
            std::vector<Obb> boxes(70000);
            glm::dvec3 heap(0.0);
            for (std::size_t i = 0; i < boxes.size(); ++i) {
                if (i % 7 == 0) heap = 1000.0 * random.vector(-1, 1);
                boxes[i].center = heap + random.vector(-1, 1);
                boxes[i].center.z = 0.0;
                boxes[i].half_extents = glm::vec3(0.1f, 0.1f, 0.0f);
            }
            const auto tree = boxtree::BoxTree::build(boxes);
            REQUIRE(tree.has_value());
            Frustum frustum;
            frustum.plane_count = 1;
            frustum.planes[0].normal = {0.0, 0.0, 1.0};
            cull::VisibleSet visible;
            cull::find_visible(*tree, {frustum}, visible, {}, pool);
            CHECK(visible.size() == boxes.size());
            if (cull::kCountStatistics) CHECK(visible.statistics().exact_tests == boxes.size());
        }
        CHECK(memory.overrun() == 0);
    }

    TEST_CASE("several threads query a tree that has doubled by insertions within the memory that they have") {
        testing::GuardedMemory memory;
        {
            ThreadPool pool(3);
            AgedTree aged(oracle::random_crowd(36000, 0.0, 37));
            oracle::NearMisses random(38);
            while (aged.tree.item_count() < 72000) aged.insert(random, glm::dvec3(0.0));
            for (int trial = 0; trial < 6; ++trial) check_view(aged, view_of(random, trial), CullMode::exact, pool);
            check_view(aged, {Frustum{}}, CullMode::exact, pool);
        }
        CHECK(memory.overrun() == 0);
    }

    TEST_CASE("several threads take a few times the memory of one, of a tree that has doubled by insertions, too") {
        const testing::CountingMemory counting;
        ThreadPool pool(3);
        AgedTree aged(oracle::random_crowd(36000, 0.0, 37));
        oracle::NearMisses random(38);
        while (aged.tree.item_count() < 72000) aged.insert(random, glm::dvec3(0.0));
        const cull::View view{*frustum_of(Camera{.position = {0.0, 0.0, 200.0}})};
        const auto taken = [&](Executor& executor) {
            const std::size_t before = counting.bytes_in_use();
            cull::VisibleSet visible;
            cull::find_visible(aged.tree, view, visible, {}, executor);
            CHECK(visible.size() > 60000);
            return counting.bytes_in_use() - before;
        };
        const std::size_t of_one = taken(serial_executor());
        CHECK(taken(pool) < 8 * of_one);
    }
}
