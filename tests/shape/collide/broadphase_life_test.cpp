// SPDX-License-Identifier: MIT
// Boxes that come and go for thousands of updates: what is told of pairs, and what an update leaves behind.
#include <doctest/doctest.h>
#include <algorithm>
#include <counting_memory.hpp>
#include <crofton/collide/broadphase.hpp>
#include <crofton/core/executor.hpp>
#include <iterator>
#include <limits>
#include <vector>

#include "../../ranges.hpp"
#include "random_boxes.hpp"

using namespace crofton;
using namespace crofton::collide;
using namespace crofton::testing;

namespace {

Obb no_box() {
    Obb box;
    box.center.x = std::numeric_limits<double>::quiet_NaN();
    return box;
}

constexpr auto is_odd_pair = [](std::uint32_t first, std::uint32_t second) { return (first + second) % 5 != 0; };

// Each pair of boxes, one after the other.
std::vector<IdPair> all_pairs(const std::vector<Obb>& boxes, const std::vector<CollisionFilter>& filters, bool tested) {
    std::vector<IdPair> pairs;
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
        if (!validate(boxes[i])) continue;
        for (std::uint32_t j = i + 1; j < boxes.size(); ++j)
            if (glm::length(boxes[i].center - boxes[j].center) < 20.0 && validate(boxes[j]) &&
                passes(filters[i], filters[j]) && (!tested || is_odd_pair(i, j)) && intersects(boxes[i], boxes[j]))
                pairs.push_back({i, j});
    }
    return pairs;
}

template <class T, class Range>
bool are_same(const std::vector<T>& expected, const Range& given) {
    return test::ranges::equal(expected, given);
}

}  // namespace

TEST_SUITE("collide/broadphase life") {
    TEST_CASE("if items move, come and go, pairs are those of all boxes, read each time or now and then") {
        std::mt19937_64 random(31);
        ThreadPool pool(3);
        for (const bool tested : {false, true})
            for (const std::size_t most : {30u, 160u}) {
                Broadphase broadphase, on_threads, seldom_asked;
                std::vector<Obb> boxes;
                std::vector<CollisionFilter> filters;
                std::vector<IdPair> before;
                std::size_t looked_at_few = 0;
                for (int frame = 0; frame < 1500; ++frame) {
                    std::vector<std::uint32_t> moved;
                    std::vector<bool> is_new(most + 64, false);
                    const std::size_t old_count = boxes.size();
                    if (frame % 300 == 0)
                        while (boxes.size() < most) boxes.push_back(random_box(random, 6.0)), filters.emplace_back();
                    for (std::uint64_t n = random() % 3; frame % 4 == 0 && n > 0 && boxes.size() < most + 60; --n)
                        boxes.push_back(random_box(random, 6.0)), filters.emplace_back();
                    for (std::uint64_t n = random() % 3; frame % 4 == 2 && n > 0 && boxes.size() > most / 2; --n)
                        boxes.pop_back(), filters.pop_back();
                    const std::size_t changes =
                        frame % 50 == 49 ? boxes.size() / 2 : random() % (2 + boxes.size() / 12);
                    for (std::size_t n = 0; n < changes; ++n) {
                        const auto item = static_cast<std::uint32_t>(random() % boxes.size());
                        moved.push_back(item);
                        switch (random() % 6) {
                            case 0:
                                boxes[item] = no_box();
                                break;
                            case 1:
                                boxes[item] = random_box(random, 6.0);
                                if (random() % 8 == 0) boxes[item].half_extents *= 8.0f;
                                break;
                            case 2:
                                filters[item] = {1u << random() % 2, static_cast<std::uint32_t>(random() % 4)};
                                break;
                            case 3:
                                boxes[item].axes[0] = glm::vec3(0.0f);
                                break;
                            default:
                                if (!validate(boxes[item])) boxes[item] = random_box(random, 6.0);
                                boxes[item].center += 0.4 * random_vector(random);
                        }
                    }
                    const auto update = [&](Broadphase& given, Executor& executor) {
                        return tested ? given.update_moved(boxes, moved, is_odd_pair, filters, executor)
                                      : given.update_moved(boxes, moved, filters, executor);
                    };
                    REQUIRE(update(broadphase, serial_executor()).has_value());
                    REQUIRE(update(on_threads, pool).has_value());
                    REQUIRE(update(seldom_asked, serial_executor()).has_value());
                    CAPTURE(frame);
                    CAPTURE(most);
                    CAPTURE(moved.size());
                    CAPTURE(boxes.size());
                    CAPTURE(old_count);
                    const auto now = all_pairs(boxes, filters, tested);
                    std::vector<IdPair> began, stayed, ended;
                    test::ranges::set_difference(now, before, std::back_inserter(began));
                    test::ranges::set_intersection(now, before, std::back_inserter(stayed));
                    test::ranges::set_difference(before, now, std::back_inserter(ended));
                    CHECK(are_same(began, broadphase.began()));
                    CHECK(are_same(ended, broadphase.ended()));
                    CHECK(are_same(now, broadphase.pairs()));
                    CHECK(are_same(stayed, broadphase.stayed()));
                    CHECK(are_same(began, on_threads.began()));
                    CHECK(are_same(ended, on_threads.ended()));
                    CHECK(are_same(stayed, on_threads.stayed()));
                    if (frame % 37 == 0) CHECK(are_same(now, seldom_asked.pairs()));
                    std::vector<std::uint32_t> rejected;
                    for (std::uint32_t i = 0; i < boxes.size(); ++i)
                        if (!validate(boxes[i])) rejected.push_back(i);
                    CHECK(are_same(rejected, broadphase.rejected()));
                    CHECK(broadphase.statistics().rejected == rejected.size());
                    CHECK(broadphase.statistics().box_pairs == now.size());
                    const BatchStatistics& decided = broadphase.statistics().boxes;
                    CHECK(broadphase.statistics().bound_pairs == decided.separated_by_face_a +
                                                                     decided.separated_by_face_b +
                                                                     decided.separated_by_edges + decided.hits);
                    CHECK(decided.refined <= broadphase.statistics().bound_pairs);
                    // What was tested: all pairs, or those of what was named or is new.
                    for (const std::uint32_t item : moved) is_new[item] = true;
                    for (std::size_t item = old_count; item < boxes.size(); ++item) is_new[item] = true;
                    std::vector<IdPair> of_new;
                    for (const IdPair& pair : now)
                        if (is_new[pair.first] || is_new[pair.second]) of_new.push_back(pair);
                    const bool few = are_same(of_new, broadphase.tested());
                    CHECK((few || are_same(now, broadphase.tested())));
                    looked_at_few += few && of_new.size() < now.size();
                    before = now;
                }
                CHECK(looked_at_few > 100);
            }
    }

    TEST_CASE("a hundred thousand that come and go leave no memory behind, and partners are found as fast") {
        CountingMemory memory;
        std::mt19937_64 random(32);
        constexpr std::uint32_t kCount = 2000;
        std::vector<Obb> boxes;
        for (std::uint32_t i = 0; i < kCount; ++i) boxes.push_back(random_box(random, 20.0));
        Broadphase broadphase;
        REQUIRE(broadphase.update(boxes).has_value());
        std::vector<std::uint32_t> some;
        for (std::uint32_t i = 0; i < kCount; i += 10) some.push_back(i);
        REQUIRE(broadphase.update_moved(boxes, some).has_value());
        const std::uint64_t fresh = broadphase.statistics().nodes_tested;
        std::size_t early = 0;
        for (int frame = 0; frame < 10000; ++frame) {
            std::vector<std::uint32_t> moved;
            for (int n = 0; n < 10; ++n) {
                moved.push_back(static_cast<std::uint32_t>(random() % kCount));
                boxes[moved.back()] = random() % 3 == 0 ? no_box() : random_box(random, 20.0);
            }
            REQUIRE(broadphase.update_moved(boxes, moved).has_value());
            REQUIRE(broadphase.statistics().bound_pairs < 200);
            if (frame == 1000) early = memory.bytes_in_use();
        }
        CHECK(static_cast<double>(memory.bytes_in_use()) < 1.2 * static_cast<double>(early));
        std::size_t valid = 0;
        for (const std::uint32_t item : some) valid += validate(boxes[item]).has_value();
        REQUIRE(broadphase.update_moved(boxes, some).has_value());
        CHECK(static_cast<double>(broadphase.statistics().nodes_tested) <
              1.5 * static_cast<double>(fresh) * static_cast<double>(valid) / static_cast<double>(some.size()) + 20.0);
        CHECK(are_same(all_pairs(boxes, std::vector<CollisionFilter>(kCount), false), broadphase.pairs()));
    }
}
