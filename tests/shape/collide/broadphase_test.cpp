// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <gmpxx.h>
#include <algorithm>
#include <crofton/collide/broadphase.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/core/executor.hpp>
#include <error_of.hpp>
#include <limits>
#include <vector>

#include "../../ranges.hpp"
#include "random_boxes.hpp"

using namespace crofton;
using namespace crofton::collide;
using namespace crofton::testing;

namespace {

std::vector<Obb> random_boxes(std::mt19937_64& random, int count, double place) {
    std::vector<Obb> boxes;
    for (int i = 0; i < count; ++i) boxes.push_back(random_box(random, place));
    return boxes;
}

std::vector<IdPair> brute_force(std::span<const Obb> boxes, std::span<const CollisionFilter> filters = {}) {
    std::vector<IdPair> pairs;
    for (std::uint32_t i = 0; i < boxes.size(); ++i)
        for (std::uint32_t j = i + 1; j < boxes.size(); ++j)
            if (validate(boxes[i]) && validate(boxes[j]) && (filters.empty() || passes(filters[i], filters[j])) &&
                intersects(boxes[i], boxes[j]))
                pairs.push_back({i, j});
    return pairs;
}

// In rational arithmetic.
bool bounds_meet(const Obb& a, const Obb& b) {
    for (int i = 0; i < 3; ++i) {
        mpq_class gap = mpq_class(b.center[i]) - mpq_class(a.center[i]), width = 0;
        for (const Obb* box : {&a, &b})
            for (int k = 0; k < 3; ++k)
                width += abs(mpq_class(double(box->axes[k][i]))) * mpq_class(double(box->half_extents[k]));
        if (abs(gap) > width) return false;
    }
    return true;
}

std::vector<IdPair> brute_force_bounds(std::span<const Obb> boxes) {
    std::vector<IdPair> pairs;
    for (std::uint32_t i = 0; i < boxes.size(); ++i)
        for (std::uint32_t j = i + 1; j < boxes.size(); ++j)
            if (bounds_meet(boxes[i], boxes[j])) pairs.push_back({i, j});
    return pairs;
}

bool same(std::span<const IdPair> a, std::span<const IdPair> b) {
    return test::ranges::equal(a, b);
}

}  // namespace

TEST_SUITE("collide/broadphase") {
    TEST_CASE(
        "`rebuilt` tells that the order of the items was made anew: at first, and when many came or went, else not") {
        std::mt19937_64 random(91);
        std::vector<Obb> boxes = random_boxes(random, 2000, 20.0);
        Broadphase broadphase;
        REQUIRE(broadphase.update(boxes));
        CHECK(broadphase.statistics().rebuilt);
        for (int frame = 0; frame < 5; ++frame) {
            for (Obb& box : boxes) box.center.x += 0.01;
            REQUIRE(broadphase.update(boxes));
            CHECK_FALSE(broadphase.statistics().rebuilt);
        }
        boxes.push_back(random_box(random, 20.0));
        REQUIRE(broadphase.update(boxes));
        CHECK_FALSE(broadphase.statistics().rebuilt);
        const std::uint32_t moved = 7;
        boxes[moved].center.y += 0.5;
        REQUIRE(broadphase.update_moved(boxes, std::span(&moved, 1)));
        CHECK_FALSE(broadphase.statistics().rebuilt);
        const std::vector<Obb> more = random_boxes(random, 2001, 20.0);
        boxes.insert(boxes.end(), more.begin(), more.end());
        REQUIRE(broadphase.update(boxes));
        CHECK(broadphase.statistics().rebuilt);
        boxes.resize(1500);
        REQUIRE(broadphase.update(boxes));
        CHECK(broadphase.statistics().rebuilt);
        REQUIRE(broadphase.update(boxes));
        CHECK_FALSE(broadphase.statistics().rebuilt);
        CHECK(std::equal(broadphase.pairs().begin(), broadphase.pairs().end(), brute_force(boxes).begin()));
    }

    TEST_CASE("no boxes and one box make no pairs") {
        Broadphase broadphase;
        CHECK(broadphase.update({}).has_value());
        CHECK(broadphase.pairs().empty());
        const Obb box;
        CHECK(broadphase.update({&box, 1}).has_value());
        CHECK(broadphase.pairs().empty());
    }

    TEST_CASE("invalid boxes are listed by index, meet nothing, and spoil nothing") {
        std::mt19937_64 random(1);
        auto boxes = random_boxes(random, 200, 3.0);
        boxes[17].center.x = std::numeric_limits<double>::quiet_NaN();
        boxes[40].half_extents.y = std::numeric_limits<float>::infinity();
        boxes[199].axes[2] = glm::vec3(0.0f);
        Broadphase broadphase;
        REQUIRE(broadphase.update(boxes).has_value());
        CHECK(test::ranges::equal(broadphase.rejected(), std::vector<std::uint32_t>{17, 40, 199}));
        CHECK(broadphase.statistics().rejected == 3);
        CHECK(same(broadphase.pairs(), brute_force(boxes)));
    }

    TEST_CASE("too many pairs are an error that keeps none, and the next update works again") {
        std::vector<Obb> boxes(1000);
        for (Obb& box : boxes) box.half_extents = glm::vec3(1.0f);
        Broadphase broadphase({.max_pairs = 1000});
        const auto result = broadphase.update(boxes);
        REQUIRE_FALSE(result.has_value());
        CHECK(error_of(result).code == ErrorCode::budget_exceeded);
        CHECK(broadphase.pairs().empty());
        boxes.resize(10);
        REQUIRE(broadphase.update(boxes).has_value());
        CHECK(broadphase.pairs().size() == 45);
        CHECK(error_of(broadphase.update(boxes, std::vector<CollisionFilter>(3))).code == ErrorCode::invalid_argument);
    }

    TEST_CASE("identical boxes, geometric series of sizes and places, and boxes at 1e30 lose no pair") {
        std::mt19937_64 random(2);
        std::vector<Obb> boxes(50, random_box(random));
        for (int i = 0; i < 100; ++i) {
            Obb box = random_box(random);
            box.center *= std::exp2(i - 50);
            box.half_extents *= std::exp2(float(i - 50));
            boxes.push_back(box);
        }
        for (int i = 0; i < 4; ++i) {
            Obb box = random_box(random);
            box.center = glm::dvec3(9e29, 0.0, -9e29) * (i % 2 ? 1.0 : -1.0);
            boxes.push_back(box);
        }
        Broadphase broadphase;
        REQUIRE(broadphase.update(boxes).has_value());
        CHECK(broadphase.pairs().size() > 50 * 49 / 2);
        CHECK(same(broadphase.pairs(), brute_force(boxes)));
    }

    TEST_CASE("filters keep pairs apart, both ways") {
        std::mt19937_64 random(3);
        const auto boxes = random_boxes(random, 400, 4.0);
        std::vector<CollisionFilter> filters;
        for (std::size_t i = 0; i < boxes.size(); ++i)
            filters.push_back({1u << (i % 3), static_cast<std::uint32_t>(random() % 8)});
        Broadphase broadphase;
        REQUIRE(broadphase.update(boxes, filters).has_value());
        CHECK_FALSE(broadphase.pairs().empty());
        CHECK(same(broadphase.pairs(), brute_force(boxes, filters)));
        CHECK(broadphase.pairs().size() < brute_force(boxes).size());
    }

    TEST_CASE(
        "many sizes in many places, from one box to thousands: all pairs, and the same with any number of threads") {
        std::mt19937_64 random(5);
        ThreadPool pool(3);
        for (const int count : {1, 15, 16, 17, 256, 257, 4097}) {
            std::vector<Obb> boxes = random_boxes(random, count, 10.0);
            for (std::size_t i = 0; i < boxes.size(); i += 7) boxes[i].half_extents *= std::exp2(float(i % 8));
            for (std::size_t i = 3; i < boxes.size(); i += 9) boxes[i].half_extents *= 0.01f;
            Broadphase serial, parallel;
            REQUIRE(serial.update(boxes).has_value());
            REQUIRE(parallel.update(boxes, {}, pool).has_value());
            CHECK(same(serial.pairs(), brute_force(boxes)));
            CHECK(same(serial.pairs(), parallel.pairs()));
            CHECK(serial.statistics().boxes.hits == serial.pairs().size());
        }
    }

    TEST_CASE("pairs of bounds hold all pairs of boxes, near and far from the origin") {
        std::mt19937_64 random(6);
        for (const double place : {0.0, 1e7, -1e15}) {
            std::vector<Obb> boxes = random_boxes(random, 500, 5.0);
            for (Obb& box : boxes) box.center += glm::dvec3(place, 0.0, place);
            Broadphase bounds({.exact_boxes = false}), exact;
            REQUIRE(bounds.update(boxes).has_value());
            REQUIRE(exact.update(boxes).has_value());
            CHECK(test::ranges::includes(bounds.pairs(), exact.pairs()));
            CHECK(same(exact.pairs(), brute_force(boxes)));
        }
    }

    TEST_CASE("pairs of bounds are exact: none too many, none too few, however near the bounds come") {
        std::mt19937_64 random(7);
        std::size_t listed = 0, apart = 0;
        for (const double place : {0.0, 3.0, 1e7, -1e15}) {
            std::vector<Obb> boxes;
            for (int n = 0; n < 60; ++n) {
                const Obb a = random_box(random, 20.0);
                Obb b = random_box(random, 20.0);
                // b's bounds touch a's along an axis, up to a rounding or two.
                const int i = n % 3;
                double width = 0.0;
                for (int k = 0; k < 3; ++k)
                    width += std::abs(double(a.axes[k][i])) * double(a.half_extents[k]) +
                             std::abs(double(b.axes[k][i])) * double(b.half_extents[k]);
                b.center = a.center;
                b.center[i] += width;
                for (int step = n % 5; step > 2; --step) b.center[i] = std::nextafter(b.center[i], 1e300);
                for (int step = n % 5; step < 2; ++step) b.center[i] = std::nextafter(b.center[i], -1e300);
                boxes.push_back(a);
                boxes.push_back(b);
            }
            for (Obb& box : boxes) box.center += glm::dvec3(place);
            Broadphase bounds({.exact_boxes = false});
            REQUIRE(bounds.update(boxes).has_value());
            CHECK(same(bounds.pairs(), brute_force_bounds(boxes)));
            for (std::size_t n = 0; n < boxes.size(); n += 2)
                (bounds_meet(boxes[n], boxes[n + 1]) ? listed : apart) += 1;
        }
        CHECK(listed > 50);
        CHECK(apart > 50);
    }

    // Widths of 1 and three times half of its last place, a little more or less: three sums round the same way.
    TEST_CASE("bounds whose widths are off by three halves of their last place are compared exactly") {
        for (const float part : {0.49f * 0x1p-52f, 0.51f * 0x1p-52f})
            for (int i = 0; i < 3; ++i)
                for (int step = 0; step < 8; ++step) {
                    Obb a;
                    a.axes = glm::mat3(1.0f);
                    a.axes[(i + 1) % 3][i] = a.axes[(i + 2) % 3][i] = 0.5f * part;
                    a.half_extents = glm::vec3(1.0f);
                    Obb b = a;
                    b.half_extents[i] = part;
                    b.center[i] = 1.0 + step * 0x1p-52;
                    const std::vector<Obb> boxes{a, b};
                    Broadphase bounds({.exact_boxes = false});
                    REQUIRE(bounds.update(boxes).has_value());
                    CHECK(bounds.pairs().size() == (step <= 1 ? 1u : 0u));
                    CHECK(bounds_meet(a, b) == (step <= 1));
                }
    }

    TEST_CASE("only the items that moved are named: the same pairs as from all boxes, frame after frame") {
        std::mt19937_64 random(8);
        for (const bool exact : {true, false}) {
            auto boxes = random_boxes(random, 700, 6.0);
            std::vector<CollisionFilter> filters(boxes.size());
            Broadphase all({.exact_boxes = exact}), few({.exact_boxes = exact});
            std::size_t looked_at = 0, began = 0, ended = 0;
            for (int frame = 0; frame < 60; ++frame) {
                std::vector<std::uint32_t> moved;
                if (frame == 30) boxes.resize(600), filters.resize(600);
                if (frame == 31) boxes.push_back(random_box(random)), filters.emplace_back();
                const std::size_t count = frame % 7 == 6 ? 0 : 1 + random() % 40;
                for (std::size_t n = 0; n < count; ++n) {
                    const auto item = static_cast<std::uint32_t>(random() % boxes.size());
                    moved.push_back(item);
                    if (n % 5 == 4) moved.push_back(item);
                    if (!validate(boxes[item])) boxes[item] = random_box(random, 6.0);
                    boxes[item].center += (n % 3 == 0 ? 3.0 : 0.3) * random_vector(random);
                    if (random() % 20 == 0) boxes[item].center.y = std::numeric_limits<double>::quiet_NaN();
                    if (random() % 10 == 0) filters[item].layers = 1u << random() % 2;
                    if (random() % 10 == 0) filters[item].collides_with = 1u << random() % 2;
                }
                REQUIRE(all.update(boxes, filters).has_value());
                REQUIRE(few.update_moved(boxes, moved, filters).has_value());
                if (frame % 4 == 1) few.release_scratch();
                if (frame % 7 == 2) all.release_scratch();
                CHECK(same(few.pairs(), all.pairs()));
                CHECK(same(few.began(), all.began()));
                CHECK(same(few.stayed(), all.stayed()));
                CHECK(same(few.ended(), all.ended()));
                CHECK(test::ranges::equal(few.rejected(), all.rejected()));
                looked_at += few.statistics().bound_pairs < all.statistics().bound_pairs;
                began += few.began().size();
                ended += few.ended().size();
            }
            CHECK(looked_at > 50);
            CHECK(began > 100);
            CHECK(ended > 100);
        }
    }

    TEST_CASE("boxes that validate only just lets pass meet others where they have moved to") {
        std::vector<Obb> boxes(40);
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            boxes[i].center.x = 10.0 * double(i);
            boxes[i].half_extents = glm::vec3(1.0f);
        }
        boxes[7].axes[0].x = 1.0f + 0.49e-4f;
        boxes[8].axes[1].x = 0.98e-4f;
        REQUIRE(validate(boxes[7]));
        REQUIRE(validate(boxes[8]));
        Broadphase broadphase;
        REQUIRE(broadphase.update(boxes));
        CHECK(broadphase.pairs().empty());
        boxes[7].center.x = 1.5;
        boxes[8].center.x = 91.5;
        REQUIRE(broadphase.update_moved(boxes, std::vector<std::uint32_t>{7, 8}));
        CHECK(same(broadphase.pairs(), std::vector<IdPair>{{0, 7}, {8, 9}}));
        CHECK(broadphase.rejected().empty());
        CHECK(broadphase.statistics().rejected == 0);
    }

    TEST_CASE("an update without moves tests nothing, and moves that name no box are an error") {
        std::mt19937_64 random(9);
        const auto boxes = random_boxes(random, 300, 4.0);
        Broadphase broadphase;
        REQUIRE(broadphase.update_moved(boxes, {}).has_value());  // the first update looks at all
        const auto pairs = brute_force(boxes);
        CHECK(same(broadphase.pairs(), pairs));
        for (int frame = 0; frame < 3; ++frame) {
            REQUIRE(broadphase.update_moved(boxes, {}).has_value());
            CHECK(same(broadphase.pairs(), pairs));
            CHECK(same(broadphase.stayed(), pairs));
            CHECK(broadphase.began().empty());
            CHECK(broadphase.statistics().bound_pairs == 0);
        }
        const std::vector<std::uint32_t> wild{4, 300};
        const auto result = broadphase.update_moved(boxes, wild);
        REQUIRE_FALSE(result.has_value());
        CHECK(error_of(result).code == ErrorCode::out_of_range);
        CHECK(error_of(result).item == 300);
        CHECK(same(broadphase.pairs(), pairs));
        const auto many = broadphase.update_moved(boxes, std::vector<std::uint32_t>(boxes.size(), 300));
        REQUIRE_FALSE(many.has_value());  // as many as there are boxes: all are looked at
        CHECK(error_of(many).item == 300);
        // All boxes far away: the order is worn out, and made anew.
        auto far = boxes;
        for (int frame = 0; frame < 40; ++frame) {
            std::vector<std::uint32_t> moved;
            for (std::uint32_t i = static_cast<std::uint32_t>(frame) % 10; i < far.size(); i += 10) {
                far[i].center += 20.0 * random_vector(random);
                moved.push_back(i);
            }
            REQUIRE(broadphase.update_moved(far, moved).has_value());
            CHECK(same(broadphase.pairs(), brute_force(far)));
        }
    }

    TEST_CASE("frame after frame of moving boxes: all pairs in order, and which began, stayed and ended") {
        std::mt19937_64 random(4);
        auto boxes = random_boxes(random, 600, 6.0);
        Broadphase broadphase;
        std::vector<IdPair> before;
        for (int frame = 0; frame < 20; ++frame) {
            if (frame == 10) boxes.resize(500);
            if (frame == 12) boxes.push_back(random_box(random, 1.0));
            REQUIRE(broadphase.update(boxes).has_value());
            const auto now = brute_force(boxes);
            CHECK(same(broadphase.pairs(), now));
            std::vector<IdPair> began, stayed, ended;
            test::ranges::set_difference(now, before, std::back_inserter(began));
            test::ranges::set_intersection(now, before, std::back_inserter(stayed));
            test::ranges::set_difference(before, now, std::back_inserter(ended));
            CHECK(same(broadphase.began(), began));
            CHECK(same(broadphase.stayed(), stayed));
            CHECK(same(broadphase.ended(), ended));
            before = now;
            const double step = frame == 15 ? 20.0 : 0.1;
            for (Obb& box : boxes) box.center += step * random_vector(random);
        }
    }

    TEST_CASE("after any error update_moved looks at all boxes") {
        std::mt19937_64 random(21);
        auto boxes = random_boxes(random, 300, 4.0);
        Broadphase broadphase;
        REQUIRE(broadphase.update(boxes).has_value());
        for (int frame = 0; frame < 20; ++frame) {
            std::vector<std::uint32_t> moved;
            for (int i = 0; i < 10; ++i) {
                moved.push_back(static_cast<std::uint32_t>(random() % boxes.size()));
                boxes[moved.back()].center = boxes[random() % boxes.size()].center;
            }
            if (frame % 2 != 0) moved.push_back(300);
            const std::vector<CollisionFilter> filters(frame % 2 != 0 ? 0 : 3);
            REQUIRE_FALSE(broadphase.update_moved(boxes, moved, filters).has_value());
            if (frame % 4 >= 2) REQUIRE_FALSE(broadphase.update(boxes, std::vector<CollisionFilter>(3)).has_value());
            REQUIRE(broadphase.update_moved(boxes, {}).has_value());
            CHECK(same(broadphase.pairs(), brute_force(boxes)));
        }
    }

    TEST_CASE("after the error for too many pairs, the pairs of the last update have ended") {
        std::vector<Obb> boxes(64);
        for (std::size_t i = 0; i < boxes.size(); ++i) boxes[i].center.x = 1.5 * static_cast<double>(i);
        for (Obb& box : boxes) box.half_extents = glm::vec3(1.0f);
        const auto apart = boxes;
        for (const bool few : {false, true}) {
            Broadphase broadphase({.max_pairs = 63});
            REQUIRE(broadphase.update(apart).has_value());
            const auto before = brute_force(apart);
            REQUIRE(before.size() == 63);
            boxes = apart;
            boxes[0].center.x = boxes[10].center.x;
            const std::vector<std::uint32_t> moved{0, 1, 2, 3, 4, 5, 6};
            for (std::size_t i = 1; i < 7; ++i) boxes[i].center = boxes[0].center;
            if (!few) boxes[20].center = boxes[19].center;
            REQUIRE_FALSE((few ? broadphase.update_moved(boxes, moved) : broadphase.update(boxes)).has_value());
            CHECK(broadphase.pairs().empty());
            CHECK(broadphase.began().empty());
            CHECK(broadphase.stayed().empty());
            CHECK(same(broadphase.ended(), before));
            REQUIRE(broadphase.update_moved(apart, {}).has_value());
            CHECK(same(broadphase.began(), before));
        }
    }
}
