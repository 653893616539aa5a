// SPDX-License-Identifier: MIT
// Queries among a set of items, by one VisibleSet that remembers sets and trees from query to query.
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/core/executor.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/classify.hpp>
#include <crofton/cull/cull.hpp>
#include <oracle/aged_tree.hpp>

#include "../../ranges.hpp"
#include "classified.hpp"

using namespace crofton;
using cull::ResultOrder;
using oracle::AgedTree;

namespace {

// A set of about this share of the items, of a few words fewer or more than they need.
std::vector<std::uint64_t> random_set(oracle::NearMisses& random, std::size_t items, double share) {
    const std::size_t needed = (items + 63) / 64;
    std::vector<std::uint64_t> set(std::max<std::size_t>(1, needed - std::min<std::size_t>(needed, random.index(3))) +
                                   random.index(2));
    for (std::uint64_t& word : set)
        for (int bit = 0; bit < 64; ++bit) word |= std::uint64_t{random.number(0.0, 1.0) < share} << bit;
    return set;
}

cull::View random_view(oracle::NearMisses& random) {
    Camera camera = random.camera();
    if (random.index(2)) {
        camera.position = 90.0 * random.direction();
        camera.forward = -camera.position;
    }
    camera.far_distance = camera.near_distance + 300.0;
    return {*frustum_of(camera), random.index(4) ? ~0u : 1u << random.index(4)};
}

// The same view without a set, less what the set leaves out: also the same order.
std::size_t check_candidates(const boxtree::BoxTree& tree, const cull::View& view, std::span<const std::uint64_t> set,
                             ResultOrder order, Executor& executor, cull::VisibleSet& kept) {
    cull::VisibleSet all;
    cull::find_visible(tree, view, all, {.order = order}, executor);
    cull::find_visible(tree, view, kept, {.order = order, .candidate_mask = set}, executor);
    std::vector<cull::ItemId> ids;
    std::vector<cull::Verdict> verdicts;
    std::size_t inside = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const cull::ItemId id = all.ids()[i];
        if (id / 64 < set.size() && (set[id / 64] >> (id % 64) & 1) == 0) continue;
        ids.push_back(id);
        if (order == ResultOrder::ascending) verdicts.push_back(all.verdicts()[i]);
        inside += order == ResultOrder::ascending ? verdicts.back() == cull::Verdict::inside : i < all.inside_count();
    }
    REQUIRE(test::ranges::equal(kept.ids(), ids));
    REQUIRE(test::ranges::equal(kept.verdicts(), verdicts));
    REQUIRE(kept.inside_count() == inside);
    return all.size() - ids.size();
}

}  // namespace

TEST_SUITE("cull/among") {
    TEST_CASE("a view among a set is the view less what the set leaves out, however often set and tree change") {
        for (const std::size_t count : {std::size_t{40}, std::size_t{900}}) {
            oracle::NearMisses random(count);
            cull::VisibleSet kept;  // of all trees, in turn
            std::size_t left_out = 0;
            oracle::for_each_age(count, count, [&](AgedTree& aged) {
                std::vector<std::uint64_t> set;
                for (int frame = 0; frame < 200; ++frame) {
                    if (frame == 0 || random.index(12) == 0)
                        set = random_set(random, aged.boxes.size(), random.index(2) ? 0.5 : 0.03);
                    if (random.index(25) == 0)
                        set[random.index(static_cast<unsigned>(set.size()))] ^= 1ull << (frame % 64);
                    if (random.index(25) == 0) aged.live(random, 5);
                    const auto order = random.index(2) ? ResultOrder::tree : ResultOrder::ascending;
                    left_out += check_candidates(aged.tree, random_view(random), set, order, serial_executor(), kept);
                }
            });
            CHECK(left_out > 20 * count);
        }
    }

    TEST_CASE("moving items are always listed, and come in their order among the static ones") {
        const oracle::Crowd crowd = oracle::random_crowd(700, 0.0, 11);
        std::vector<cull::ItemId> items;
        std::vector<Obb> boxes;
        for (cull::ItemId i = 0; i < crowd.boxes.size(); i += 5) items.push_back(i), boxes.push_back(crowd.boxes[i]);
        const auto tree = boxtree::BoxTree::build(crowd.boxes, crowd.layers, {.detached = items}).value();
        cull::MovingBoxes moving;
        REQUIRE(moving.update(tree, items, boxes).has_value());
        oracle::NearMisses random(13);
        cull::VisibleSet all, kept;
        std::size_t left_out = 0, moved = 0;
        std::vector<std::uint64_t> set;
        for (int frame = 0; frame < 120; ++frame) {
            if (frame % 15 == 0) set = random_set(random, crowd.boxes.size(), frame % 2 ? 0.03 : 0.5);
            const auto order = random.index(2) ? ResultOrder::tree : ResultOrder::ascending;
            const cull::View view = random_view(random);
            cull::find_visible(tree, moving, view, all, {.order = order});
            cull::find_visible(tree, moving, view, kept, {.order = order, .candidate_mask = set});
            std::vector<cull::ItemId> ids;
            for (const cull::ItemId id : all.ids())
                if (id % 5 == 0 || cull::is_candidate(set, id)) ids.push_back(id), moved += id % 5 == 0;
            REQUIRE(test::ranges::equal(kept.ids(), ids));
            left_out += all.size() - ids.size();
        }
        CHECK(left_out > 1000);
        CHECK(moved > 1000);
    }

    TEST_CASE("a few visible items among many are listed by id, each with its own verdict") {
        oracle::NearMisses random(17);
        std::vector<Obb> boxes(40000);  // 625 words of bits: up to 19 ids are few
        for (Obb& box : boxes) {
            box.center = {random.number(-50, 50), random.number(-50, 50), random.number(-50, 50)};
            box.half_extents = glm::vec3(static_cast<float>(random.number(0.1, 0.5)));
        }
        const auto tree = boxtree::BoxTree::build(boxes).value();
        const auto set = random_set(random, boxes.size(), 0.7);
        cull::VisibleSet seen;
        std::size_t few = 0, straddling = 0;
        for (int frame = 0; frame < 60; ++frame) {
            Camera camera;
            camera.position = {random.number(-40, 40), random.number(-40, 40), random.number(-40, 40)};
            camera.forward = random.direction();
            camera.near_distance = 0.1;
            camera.far_distance = random.number(1.0, 9.0);
            const Frustum frustum = *frustum_of(camera);
            const bool among = random.index(2) != 0;
            std::vector<std::uint32_t> layers(boxes.size());
            for (cull::ItemId i = 0; i < boxes.size(); ++i) layers[i] = !among || cull::is_candidate(set, i) ? 1u : 0u;
            const testing::Classified expected(boxes, layers, {frustum});
            straddling += expected.ids.size() - expected.inside_count();
            cull::CullOptions options;
            if (among) options.candidate_mask = set;
            cull::find_visible(tree, cull::View{frustum}, seen, options);
            REQUIRE(expected.is_answer(seen));
            few += expected.ids.size() > 1 && expected.ids.size() < 19;
        }
        CHECK(few > 5);
        CHECK(few < 50);
        CHECK(straddling > 300);
    }

    TEST_CASE("each of two trees with the same items has its own slots") {
        const oracle::Crowd crowd = oracle::random_crowd(600, 0.0, 3);
        const auto one = boxtree::BoxTree::build(crowd.boxes).value();
        const auto other = boxtree::BoxTree::build(crowd.boxes, {.criterion = measure::minimal_volume()}).value();
        oracle::NearMisses random(5);
        const auto set = random_set(random, crowd.boxes.size(), 0.04);
        cull::VisibleSet kept;
        std::size_t left_out = 0;
        for (int frame = 0; frame < 40; ++frame)
            left_out += check_candidates(random.index(2) ? one : other, random_view(random), set, ResultOrder::tree,
                                         serial_executor(), kept);
        CHECK(left_out > 1000);
    }

    TEST_CASE("threads that share a large tree leave out the same items in the same order") {
        const oracle::Crowd crowd = oracle::random_crowd(70000, 0.0, 7);
        const auto tree = boxtree::BoxTree::build(crowd.boxes, crowd.layers).value();
        oracle::NearMisses random(9);
        ThreadPool pool(3);
        const auto set = random_set(random, crowd.boxes.size(), 0.3);
        cull::VisibleSet kept, by_one;
        for (int frame = 0; frame < 8; ++frame) {
            const cull::View view = random_view(random);
            const auto order = frame % 2 ? ResultOrder::tree : ResultOrder::ascending;
            Executor& executor = frame % 4 < 2 ? static_cast<Executor&>(pool) : serial_executor();
            (void)check_candidates(tree, view, set, order, executor, kept);
            cull::find_visible(tree, view, by_one, {.order = order, .candidate_mask = set});
            REQUIRE(test::ranges::equal(by_one.ids(), kept.ids()));
        }
    }
}
