// SPDX-License-Identifier: MIT
// What must hold over many frames: no allocation, no rot, the same bits for any number of threads and any instruction
// set.
#include <doctest/doctest.h>
#include <hwy/targets.h>
#include <algorithm>
#include <counting_memory.hpp>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <oracle/random_boxes.hpp>
#include <vector>

#include "../../ranges.hpp"

using namespace crofton;

namespace {

std::vector<cull::View> flight(std::size_t frames) {
    std::vector<cull::View> views;
    for (std::size_t f = 0; f < frames; ++f) {
        Camera camera;
        const double angle = 0.1 * static_cast<double>(f);
        camera.position = {30.0 * std::cos(angle), 5.0 * std::sin(2.0 * angle), 30.0 * std::sin(angle)};
        camera.forward = {-std::cos(angle + 0.5), 0.1, -std::sin(angle + 0.5)};
        camera.far_distance = 70.0;
        views.push_back({*frustum_of(camera)});
    }
    return views;
}

// An axis-aligned box around each box, and a sphere within it.
struct OtherBounds {
    explicit OtherBounds(const std::vector<Obb>& boxes) {
        for (const Obb& box : boxes) {
            aabbs.push_back(aabb_of(box));
            spheres.push_back({box.center, double{box.half_extents.x}});
        }
        aabb_set.assign(aabbs);
        sphere_set.assign(spheres);
    }
    std::vector<Aabb> aabbs;
    std::vector<Sphere> spheres;
    cull::AabbSet aabb_set;
    cull::SphereSet sphere_set;
};

}  // namespace

TEST_SUITE("cull/frame") {
    TEST_CASE("after the first frame nothing is allocated, moves and refits included") {
        const testing::CountingMemory counting;
        oracle::NearMisses random(3);
        const oracle::Crowd crowd = oracle::random_crowd(5000, 0.0, 2);
        boxtree::BoxTree tree = *boxtree::BoxTree::build(crowd.boxes, crowd.layers);
        cull::BoxSet set;
        set.assign(crowd.boxes);
        cull::VisibleSet visible;
        cull::MaskedVisibleSet many;
        cull::VerdictBits bits;
        const OtherBounds others(crowd.boxes);
        std::vector<std::uint32_t> masks(crowd.boxes.size()), items{1, 70, 4999};
        const std::vector<cull::View> views = flight(40);
        std::size_t warm = 0;
        for (std::size_t f = 0; f < 2 * views.size(); ++f) {
            for (boxtree::ItemId i = 0; i < 500; ++i)
                REQUIRE(tree.move(7 * i, oracle::random_box(random, glm::dvec3(0.0), 40.0)).has_value());
            tree.refit();
            const std::size_t at = f % views.size();
            cull::find_visible(tree, views[at], visible,
                               {cull::CullMode::exact, f % 2 ? cull::ResultOrder::ascending : cull::ResultOrder::tree});
            (void)cull::find_visible(tree, std::span(views).subspan(at / 2, 4), many);
            set.update(items, crowd.boxes);
            cull::find_visible(set, crowd.boxes, views[at], bits);
            cull::find_visible(others.aabb_set, others.aabbs, views[at], bits);
            cull::find_visible(others.sphere_set, others.spheres, views[at], bits);
            (void)cull::find_visible(set, crowd.boxes, crowd.layers, std::span(views).subspan(at / 2, 4), masks);
            if (f == views.size()) warm = counting.allocations();
        }
        CHECK(warm > 0);
        CHECK(counting.allocations() == warm);
    }

    TEST_CASE("any number of threads gives the same ids in the same order, and the same statistics") {
        const oracle::Crowd crowd = oracle::random_crowd(100000, 0.0, 4);
        ThreadPool three(3);
        const boxtree::BoxTree tree = *boxtree::BoxTree::build(crowd.boxes, crowd.layers);
        const boxtree::BoxTree tree_of_three = *boxtree::BoxTree::build(crowd.boxes, crowd.layers, {}, three);
        CHECK(test::ranges::equal(tree.structure().slot_items(), tree_of_three.structure().slot_items()));
        cull::BoxSet set;
        set.assign(crowd.boxes, three);
        cull::VisibleSet one, many;
        cull::VerdictBits one_bits, many_bits;
        for (const cull::View& view : flight(20))
            for (const cull::ResultOrder order : {cull::ResultOrder::tree, cull::ResultOrder::ascending}) {
                cull::find_visible(tree, view, one, {cull::CullMode::exact, order});
                cull::find_visible(tree, view, many, {cull::CullMode::exact, order}, three);
                CHECK(one.inside_count() == many.inside_count());
                REQUIRE(one.size() == many.size());
                CHECK(test::ranges::equal(one.ids(), many.ids()));
                CHECK(test::ranges::equal(one.verdicts(), many.verdicts()));
                CHECK(one.statistics().boxes_tested == many.statistics().boxes_tested);
                CHECK(one.statistics().false_positives == many.statistics().false_positives);
                cull::find_visible(set, crowd.boxes, view, one_bits);
                cull::find_visible(set, crowd.boxes, view, many_bits, cull::CullMode::exact, three);
                CHECK(one_bits.visible == many_bits.visible);
                CHECK(one_bits.inside == many_bits.inside);
                CHECK(one_bits.statistics.false_positives == many_bits.statistics.false_positives);
            }
    }

    TEST_CASE("every instruction set that this machine has gives the same verdicts") {
        const oracle::Crowd crowd = oracle::random_crowd(20000, 1e6, 5);
        const boxtree::BoxTree tree = *boxtree::BoxTree::build(crowd.boxes, crowd.layers);
        cull::BoxSet set;
        set.assign(crowd.boxes);
        const OtherBounds others(crowd.boxes);
        std::vector<cull::View> views = flight(6);
        for (cull::View& view : views) view.frustum.origin += 1e6 * glm::dvec3(1.0, -0.7, 0.3);
        struct Answer {
            std::vector<cull::ItemId> ids;
            std::vector<cull::Verdict> verdicts;
            std::vector<Vector<std::uint64_t>> visible, inside;  // of boxes, axis-aligned boxes, spheres
            std::vector<std::uint32_t> masks;
            bool operator==(const Answer&) const = default;
        };
        const auto answer = [&] {
            std::vector<Answer> answers;
            for (const cull::View& view : views)
                for (const cull::CullMode mode : {cull::CullMode::conservative, cull::CullMode::exact}) {
                    cull::VisibleSet visible;
                    cull::VerdictBits bits;
                    cull::find_visible(tree, view, visible, {mode});
                    Answer one{{visible.ids().begin(), visible.ids().end()},
                               {visible.verdicts().begin(), visible.verdicts().end()},
                               {},
                               {},
                               std::vector<std::uint32_t>(crowd.boxes.size())};
                    const auto keep = [&] {
                        one.visible.push_back(bits.visible);
                        one.inside.push_back(bits.inside);
                    };
                    cull::find_visible(set, crowd.boxes, view, bits, mode);
                    keep();
                    cull::find_visible(others.aabb_set, others.aabbs, view, bits, mode);
                    keep();
                    cull::find_visible(others.sphere_set, others.spheres, view, bits, mode);
                    keep();
                    (void)cull::find_visible(set, crowd.boxes, crowd.layers, views, one.masks, mode);
                    answers.push_back(one);
                }
            return answers;
        };
        const std::vector<Answer> best = answer();
        CHECK(best[0].ids.size() > 100);
        for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
            hwy::SetSupportedTargetsForTest(rest & -rest);
            CHECK(answer() == best);
        }
        hwy::SetSupportedTargetsForTest(0);
    }

    TEST_CASE("after long random motion a query tests hardly more than in a fresh tree, if rebuilt in the background") {
        oracle::NearMisses random(6);
        oracle::Crowd crowd = oracle::random_crowd(4000, 0.0, 6);
        boxtree::BoxTree tree = *boxtree::BoxTree::build(crowd.boxes);
        boxtree::BoxTree neglected = *boxtree::BoxTree::build(crowd.boxes);
        for (int frame = 0; frame < 10000; ++frame) {
            for (int n = 0; n < 100; ++n) {
                const boxtree::ItemId item = random.index(4000);
                Obb& box = crowd.boxes[item];
                box.center = glm::clamp(box.center + 1.0 * random.direction(), glm::dvec3(-40.0), glm::dvec3(40.0));
                REQUIRE(tree.move(item, box).has_value());
                REQUIRE(neglected.move(item, box).has_value());
            }
            tree.refit();
            (void)tree.rebuild_step(2000);
        }
        neglected.refit();
        const boxtree::BoxTree fresh = *boxtree::BoxTree::build(crowd.boxes);
        std::uint64_t cost = 0, fresh_cost = 0, neglected_cost = 0;
        cull::VisibleSet visible;
        const auto tested = [&](const boxtree::BoxTree& of, const cull::View& view) {
            cull::find_visible(of, view, visible);
            return visible.statistics().nodes_tested + visible.statistics().boxes_tested;
        };
        for (const cull::View& view : flight(40)) {
            cost += tested(tree, view);
            fresh_cost += tested(fresh, view);
            neglected_cost += tested(neglected, view);
        }
        if (!cull::kCountStatistics) return;
        CHECK(static_cast<double>(cost) <= 1.1 * static_cast<double>(fresh_cost));
        CHECK(static_cast<double>(neglected_cost) > 1.5 * static_cast<double>(fresh_cost));
    }
}
