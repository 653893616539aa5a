// SPDX-License-Identifier: MIT
// What queries count is part of their answer: the same on every instruction set.
#include <doctest/doctest.h>
#include <hwy/targets.h>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <oracle/near_misses.hpp>
#include <vector>

using namespace crofton;

namespace {

using Counts = std::vector<std::uint64_t>;

// Not exact_tests: how many are too near to call in floats depends on whether products are fused.
void add(const cull::Statistics& s, Counts& counts) {
    for (const std::uint64_t n : {s.nodes_tested, s.boxes_tested, s.accepted_whole, s.straddling, s.false_positives})
        counts.push_back(n);
}

// A crowd some of whose boxes are long, and much of which lies near a plane of the view.
std::vector<Obb> crowd_of(oracle::NearMisses& random, const Frustum& frustum, std::size_t count) {
    const auto corners = *frustum_corners(frustum);
    std::vector<Obb> boxes;
    for (std::size_t i = 0; i < count; ++i) {
        Obb box;
        const glm::dvec3 axis = random.direction();
        const double angle = random.number(0.0, 6.2);
        box.axes = glm::mat3(glm::mat3_cast(glm::dquat(std::cos(angle / 2), std::sin(angle / 2) * axis)));
        box.center = random.surface_point(frustum, corners);
        const double away = std::exp(random.number(-8.0, 3.0));
        box.center += away * random.direction();
        for (int k = 0; k < 3; ++k) box.half_extents[k] = float(std::exp(random.number(-4.0, 1.0)));
        boxes.push_back(box);
    }
    return boxes;
}

Counts counts_of(const std::vector<Obb>& boxes, const boxtree::BoxTree& tree, const cull::BoxSet& set,
                 const std::vector<cull::View>& views) {
    Counts counts;
    cull::VisibleSet visible;
    cull::VerdictBits bits;
    for (const cull::CullMode mode : {cull::CullMode::exact, cull::CullMode::conservative}) {
        for (const cull::View& view : views) {
            cull::find_visible(boxes, {}, view, visible, {mode});
            add(visible.statistics(), counts);
            cull::find_visible(tree, view, visible, {mode});
            add(visible.statistics(), counts);
            cull::find_visible(set, boxes, view, bits, mode);
            add(bits.statistics, counts);
        }
    }
    return counts;
}

}  // namespace

TEST_SUITE("cull/statistics") {
    TEST_CASE("every instruction set counts the same") {
        std::uint64_t straddling = 0;
        for (std::uint64_t trial = 0; trial < 40; ++trial) {
            oracle::NearMisses random(700 + trial, trial % 4 == 3 ? 1e6 : 0.0);
            std::vector<cull::View> views(3);
            for (cull::View& view : views) view.frustum = *frustum_of(random.camera());
            const std::vector<Obb> boxes = crowd_of(random, views[0].frustum, 3000);
            const auto tree = *boxtree::BoxTree::build(boxes);
            cull::BoxSet set;
            set.assign(boxes);
            const std::int64_t all = hwy::SupportedTargets();
            hwy::SetSupportedTargetsForTest(all & -all);
            const Counts expected = counts_of(boxes, tree, set, views);
            for (std::int64_t rest = all & (all - 1); rest != 0; rest &= rest - 1) {
                hwy::SetSupportedTargetsForTest(rest & -rest);
                CAPTURE(trial);
                CAPTURE(hwy::TargetName(rest & -rest));
                const Counts counts = counts_of(boxes, tree, set, views);
                REQUIRE(counts.size() == expected.size());
                for (std::size_t i = 0; i < counts.size(); ++i) {
                    CAPTURE(i);
                    CHECK(counts[i] == expected[i]);
                }
            }
            hwy::SetSupportedTargetsForTest(0);
            straddling += expected[3];
        }
        CHECK(straddling > 10'000);
    }
}
