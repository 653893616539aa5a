// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <hwy/targets.h>
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <limits>
#include <vector>

#include "oracle/exact_boxes.hpp"
#include "random_boxes.hpp"

using namespace crofton;
using namespace crofton::collide;
using namespace crofton::testing;

namespace {

Obb unit_box(const glm::dvec3& center) {
    Obb box;
    box.center = center;
    box.half_extents = glm::vec3(0.5f);
    return box;
}

}  // namespace

TEST_SUITE("collide/obb_obb") {
    TEST_CASE("a box that is not finite meets nothing, not even itself") {
        Obb bad = unit_box({});
        bad.center.y = std::numeric_limits<double>::quiet_NaN();
        CHECK_FALSE(intersects(bad, unit_box({})));
        CHECK_FALSE(intersects(unit_box({}), bad));
        CHECK_FALSE(intersects(bad, bad));
        bad = unit_box({});
        bad.axes[1].x = std::numeric_limits<float>::infinity();
        CHECK_FALSE(intersects(bad, unit_box({})));
    }

    TEST_CASE("one number that is not finite, whichever it is, and a box meets nothing") {
        std::mt19937_64 random(8);
        const double infinity = std::numeric_limits<double>::infinity();
        for (int trial = 0; trial < 20; ++trial) {
            const Obb other = trial % 2 == 0 ? unit_box({}) : random_box(random, 0.1);
            Obb box = trial % 4 < 2 ? unit_box({}) : random_box(random, 0.1);
            if (trial % 5 == 0) box.half_extents[trial % 3] = 0.0f;
            REQUIRE(intersects(box, other));
            for (const double value : {std::numeric_limits<double>::quiet_NaN(), infinity, -infinity})
                for (int number = 0; number < 15; ++number) {
                    CAPTURE(number);
                    CAPTURE(value);
                    Obb bad = box;
                    if (number < 3)
                        bad.center[number] = value;
                    else if (number < 6)
                        bad.half_extents[number - 3] = float(value);
                    else
                        bad.axes[(number - 6) / 3][(number - 6) % 3] = float(value);
                    CHECK_FALSE(intersects(bad, other));
                    CHECK_FALSE(intersects(other, bad));
                    CHECK_FALSE(intersects(bad, bad));
                    CHECK(separating_axis(bad, other) != kNotSeparated);
                    CHECK(separating_axis(other, bad, 3) != kNotSeparated);
                }
        }
    }

    TEST_CASE("points, segments and rectangles are boxes with zero extents") {
        Obb point = unit_box({0.5, 0.5, 0.5});
        point.half_extents = glm::vec3(0.0f);
        CHECK(intersects(point, unit_box({})));
        CHECK(intersects(point, point));
        point.center.x = std::nextafter(0.5, 1.0);
        CHECK_FALSE(intersects(point, unit_box({})));
        Obb segment = point;
        segment.center = {0.0, 0.0, 0.0};
        segment.half_extents = {1.0f, 0.0f, 0.0f};
        Obb other = segment;
        other.axes = glm::mat3(glm::vec3(0, 1, 0), glm::vec3(-1, 0, 0), glm::vec3(0, 0, 1));
        CHECK(intersects(segment, other));
        other.center.z = std::numeric_limits<double>::denorm_min();
        CHECK_FALSE(intersects(segment, other));
    }

    TEST_CASE("touching is a hit, one bit further is not, also far from the origin") {
        for (const double place : {0.0, 1e7, -1e15}) {
            const Obb a = unit_box({place, 0.0, 0.0});
            CHECK(intersects(a, unit_box({place + 1.0, 1.0, -1.0})));
            CHECK_FALSE(intersects(a, unit_box({std::nextafter(place + 1.0, 1e30), 0.0, 0.0})));
        }
    }

    TEST_CASE("the smallest and the largest boxes that are allowed keep their exact answers") {
        Obb large = unit_box({-1e30, 0.0, 0.0}), other = large;
        large.half_extents = other.half_extents = glm::vec3(1e30f);
        other.center.x = large.center.x + 2.0 * double(1e30f);
        CHECK(intersects(large, other));
        other.center.x = std::nextafter(other.center.x, 2e30);
        CHECK_FALSE(intersects(large, other));
        Obb tiny = unit_box({});
        tiny.half_extents = glm::vec3(std::numeric_limits<float>::denorm_min());
        Obb next = tiny;
        next.center.y = 2.0 * double(std::numeric_limits<float>::denorm_min());
        CHECK(intersects(tiny, next));
        next.center.y = std::nextafter(next.center.y, 1.0);
        CHECK_FALSE(intersects(tiny, next));
    }

    TEST_CASE("the smallest step off a tilted rectangle's plane is seen") {
        std::mt19937_64 random(6);
        Obb rectangle = random_box(random), point = rectangle;
        rectangle.center = {};
        rectangle.half_extents = {1.0f, 1.0f, 0.0f};
        point.half_extents = glm::vec3(0.0f);
        point.center = {};
        CHECK(intersects(rectangle, point));
        for (int i = 0; i < 3; ++i) {
            point.center = {};
            point.center[i] = std::numeric_limits<double>::denorm_min();
            CHECK_FALSE(intersects(rectangle, point));
        }
    }

    TEST_CASE("20,000 pairs that touch as nearly as double can say are answered as rational arithmetic answers them") {
        std::mt19937_64 random(77);
        int wrong = 0, hits = 0;
        for (int trial = 0; trial < 20000; ++trial) {
            const auto [a, b] =
                nearly_touching(random, {.parallel = trial % 2 == 0, .half_turned = trial % 4 == 1, .no_gap = true});
            const bool truth = oracle::boxes_meet_by_integers(a, b);
            wrong += intersects(a, b) != truth;
            hits += truth;
        }
        CHECK(wrong == 0);
        CHECK(hits > 6000);
        CHECK(hits < 14000);
    }

    TEST_CASE("20,000 crates that share a frame, its axes in any order and sign, touching or nearly so: none wrong") {
        std::mt19937_64 random(78);
        int wrong = 0, hits = 0;
        for (int trial = 0; trial < 20000; ++trial) {
            const auto [a, b] = crates_of_one_frame(random);
            const bool truth = oracle::boxes_meet_by_integers(a, b);
            wrong += intersects(a, b) != truth;
            wrong += (separating_axis(b, a) == kNotSeparated) != truth;
            hits += truth;
        }
        CHECK(wrong == 0);
        CHECK(hits > 6000);
        CHECK(hits < 16000);
    }

    TEST_CASE("20,000 crates that are not turned, of sizes from 1e-40 to 1e30, touching or one bit off: none wrong") {
        std::mt19937_64 random(79);
        std::uniform_real_distribution<double> number(0.0, 1.0);
        int wrong = 0, hits = 0, edges = 0;
        for (int trial = 0; trial < 20000; ++trial) {
            Obb a = unit_box({}), b = a;
            const double size = std::pow(10.0, -40.0 + 70.0 * number(random));
            int touching = 0;
            for (int k = 0; k < 3; ++k) {
                // Half extents whose sum no double holds, and alike ones.
                const double ratio = std::pow(10.0, (trial % 2 == 0 ? -30.0 : -1.0) * number(random));
                a.half_extents[k] = static_cast<float>(size * number(random));
                b.half_extents[k] = static_cast<float>(std::min(1e30, size * ratio * number(random)));
                const double sum = double(a.half_extents[k]) + double(b.half_extents[k]);
                const bool touches = number(random) < 0.6;
                touching += touches;
                a.center[k] = trial % 3 == 0 ? 0.0 : size * (number(random) - 0.5);
                b.center[k] = a.center[k] + (touches ? sum : sum * number(random));
                if (touches && number(random) < 0.3)
                    b.center[k] = std::nextafter(b.center[k], number(random) < 0.5 ? 1e35 : -1e35);
                if (number(random) < 0.5) std::swap(a.center[k], b.center[k]);
            }
            const bool truth = oracle::boxes_meet_by_integers(a, b);
            wrong += intersects(a, b) != truth;
            wrong += intersects(b, a) != truth;
            wrong += (separating_axis(a, b) == kNotSeparated) != truth;
            wrong += (contact_manifold(a, b).count > 0) != truth;
            hits += truth;
            edges += touching > 1;
        }
        CHECK(wrong == 0);
        CHECK(hits > 4000);
        CHECK(hits < 17000);
        CHECK(edges > 5000);
    }

    TEST_CASE("gives the same axis on every instruction set") {
        std::vector<int> expected;
        for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
            hwy::SetSupportedTargetsForTest(rest & -rest);
            std::vector<int> axes;
            std::mt19937_64 random(9);
            for (int trial = 0; trial < 12000; ++trial) {
                const auto [a, b] =
                    trial % 4 == 3 ? crates_of_one_frame(random)
                                   : nearly_touching(random, {.parallel = trial % 2 == 0, .no_gap = trial % 3 == 0});
                axes.push_back(separating_axis(a, b));
                axes.push_back(separating_axis(a, b, trial % kAxisCount));
            }
            if (expected.empty()) expected = axes;
            CHECK(axes == expected);
        }
        hwy::SetSupportedTargetsForTest(0);
    }

    TEST_CASE("separating_axis distinguishes the fifteen axes, in either order of the boxes") {
        std::mt19937_64 random(5);
        std::uint32_t seen = 0;
        for (int trial = 0; trial < 3000; ++trial) {
            const auto [a, b] = nearly_touching(random, {});
            const int axis = separating_axis(a, b);
            if (axis >= 0) seen |= 1u << axis;
            CHECK((separating_axis(b, a) == kNotSeparated) == (axis == kNotSeparated));
            if (axis >= 0) CHECK(separating_axis(a, b, axis) == axis);
            CHECK((separating_axis(a, b, 14) == kNotSeparated) == (axis == kNotSeparated));
        }
        CHECK(seen == 0x7fffu);
    }

    TEST_CASE("the oracles agree with each other and with us, degenerate boxes included") {
        std::mt19937_64 random(11);
        int hits = 0;
        for (int trial = 0; trial < 300; ++trial) {
            auto [a, b] = nearly_touching(random, {.parallel = trial % 2 == 0, .float_centers = true});
            if (trial % 3 == 0) a.half_extents[trial % 2] = 0.0f;
            if (trial % 5 == 0) b.half_extents = glm::vec3(0.0f, 0.3f, 0.0f);
            const bool truth = oracle::boxes_meet_by_vertices(a, b);
            hits += truth;
            CHECK(oracle::boxes_meet_by_axes<oracle::Rational>(a, b) == truth);
            CHECK(oracle::boxes_meet_by_integers(a, b) == truth);
            CHECK(intersects(a, b) == truth);
        }
        CHECK(hits > 50);
    }

    // Gaps and angles of all decades in turn, hits and misses in each; one by one and in batches.
    void check_class(const NearTouch& kind) {
        std::mt19937_64 random(2024);
        std::vector<Obb> first, second;
        std::vector<std::uint8_t> truth, batch(60000);
        int hits[16] = {}, wrong = 0;
        for (int trial = 0; trial < 60000; ++trial) {
            NearTouch decade = kind;
            decade.gap_decade = 1 + trial % 15;
            decade.angle_decade = 1 + trial / 15 % 12;
            const auto [a, b] = nearly_touching(random, decade);
            first.push_back(a);
            second.push_back(b);
            truth.push_back(oracle::boxes_meet_by_integers(a, b));
            hits[decade.gap_decade] += truth.back();
            wrong += intersects(a, b) != bool(truth.back());
        }
        CHECK(wrong == 0);
        intersects(first, second, batch);
        CHECK(batch == truth);
        for (int decade = 1; decade <= 15; ++decade) {
            CAPTURE(decade);
            CHECK(hits[decade] > 1000);
            CHECK(hits[decade] < 3000);
        }
    }

    TEST_CASE("60,000 pairs with gaps of 1e-1 to 1e-15, generic, in double: none wrong") {
        check_class({});
    }
    TEST_CASE("60,000 pairs with gaps of 1e-1 to 1e-15, generic, centres rounded to float: none wrong") {
        check_class({.float_centers = true});
    }
    TEST_CASE("60,000 pairs with gaps of 1e-1 to 1e-15, turned by 1e-1 to 1e-12, in double: none wrong") {
        check_class({.parallel = true});
    }
    TEST_CASE(
        "60,000 pairs with gaps of 1e-1 to 1e-15, turned by 1e-1 to 1e-12, centres rounded to float: none wrong") {
        check_class({.parallel = true, .float_centers = true});
    }
}
