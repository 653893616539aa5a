// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/collide/narrow_phase.hpp>
#include <limits>
#include <vector>

#include "random_boxes.hpp"

using namespace crofton;
using namespace crofton::collide;
using namespace crofton::testing;

namespace {

std::uint64_t total(const BatchStatistics& s) {
    return s.separated_by_face_a + s.separated_by_face_b + s.separated_by_edges + s.hits;
}

// Both forms against the single test.
void check(const std::vector<Obb>& a, const std::vector<Obb>& b) {
    std::vector<std::uint8_t> expected, hits(a.size(), 7), indexed(a.size(), 7);
    std::vector<Obb> both;
    std::vector<IdPair> pairs;
    for (std::uint32_t i = 0; i < a.size(); ++i) {
        expected.push_back(intersects(a[i], b[i]));
        both.push_back(a[i]);
        both.push_back(b[i]);
        pairs.push_back({2 * i, 2 * i + 1});
    }
    const BatchStatistics statistics = intersects(a, b, hits);
    CHECK(hits == expected);
    CHECK(total(statistics) == a.size());
    CHECK(total(intersects(both, pairs, indexed)) == a.size());
    CHECK(indexed == expected);
}

}  // namespace

TEST_SUITE("collide/obb_batch") {
    TEST_CASE("no pairs are no work, and boxes that are not finite meet nothing and spoil no neighbour") {
        check({}, {});
        std::mt19937_64 random(1);
        std::vector<Obb> a, b;
        for (int i = 0; i < 37; ++i) {
            a.push_back(random_box(random));
            b.push_back(random_box(random));
        }
        a[3].center.x = std::numeric_limits<double>::quiet_NaN();
        b[4].half_extents.y = std::numeric_limits<float>::quiet_NaN();
        a[20].axes[1].z = std::numeric_limits<float>::quiet_NaN();
        b[21].axes[0].x = std::numeric_limits<float>::infinity();
        a[36].half_extents.x = std::numeric_limits<float>::infinity();
        check(a, b);
    }

    TEST_CASE("boxes from 1e-38 to 1e30, needles, plates and points are answered as one by one") {
        std::mt19937_64 random(2);
        std::vector<Obb> a, b;
        for (int i = 0; i < 3000; ++i) {
            const float size = std::pow(10.0f, float(int(random() % 69) - 38));
            auto [first, second] = nearly_touching(random, {.parallel = i % 2 == 0, .no_gap = i % 3 == 0});
            for (Obb* box : {&first, &second}) {
                box->center *= double(size);
                box->half_extents *= size;
            }
            if (i % 5 == 0) first.half_extents[i % 3] *= 1e-6f;
            if (i % 7 == 0) second.half_extents = glm::vec3(0.0f);
            a.push_back(first);
            b.push_back(second);
        }
        check(a, b);
    }

    TEST_CASE("40,000 pairs that nearly touch, at the origin and far from it") {
        std::mt19937_64 random(3);
        for (int kind = 0; kind < 4; ++kind) {
            std::vector<Obb> a, b;
            const glm::dvec3 place = kind == 1 ? glm::dvec3(1e6, -3e6, 2e5) : glm::dvec3(0.0);
            for (int i = 0; i < 10000; ++i) {
                auto [first, second] = nearly_touching(random, {.parallel = kind == 2, .float_centers = kind == 3});
                first.center += place;
                second.center += place;
                a.push_back(first);
                b.push_back(second);
            }
            check(a, b);
        }
    }

    TEST_CASE("specks whose centres floats round away from each other, by half a step each, meet nevertheless") {
        std::vector<Obb> a, b;
        for (int power = -20; power <= 20; ++power)
            for (int axis = 0; axis < 3; ++axis)
                for (const double sign : {-1.0, 1.0}) {
                    Obb box{};
                    box.axes = glm::mat3(1.0f);
                    box.half_extents[axis] = std::ldexp(0.03f, power - 24);
                    // Halfway between two floats, a little below and a little above: their floats are a step apart.
                    box.center[axis] = sign * std::ldexp(1.0 + 0x1p-24 * 0.98, power);
                    a.push_back(box);
                    box.center[axis] = sign * std::ldexp(1.0 + 0x1p-24 * 1.02, power);
                    b.push_back(box);
                    REQUIRE(separating_axis(a.back(), b.back(), 0) == kNotSeparated);
                }
        check(a, b);
    }

    TEST_CASE("boxes with parallel edges that overlap clearly are decided in float") {
        std::mt19937_64 random(6);
        std::vector<Obb> a, b;
        for (int i = 0; i < 20000; ++i) {
            Obb box = random_box(random);
            if (i % 2 == 0) {  // upright, and turned about the vertical
                box.axes =
                    glm::mat3(glm::mat3_cast(glm::angleAxis(random_vector(random).x, glm::dvec3(0.0, 0.0, 1.0))));
            }
            a.push_back(box);
            const glm::dmat3 turn = glm::mat3_cast(glm::angleAxis(random_vector(random).y, glm::dvec3(box.axes[2])));
            box.axes = glm::mat3(turn * glm::dmat3(box.axes));
            box.center += 0.1 * random_vector(random);
            b.push_back(box);
        }
        std::vector<std::uint8_t> hits(a.size());
        const BatchStatistics statistics = intersects(a, b, hits);
        CHECK(statistics.hits == a.size());
        CHECK(statistics.refined < a.size() / 500);
    }

    TEST_CASE("float decides nearly all random pairs") {
        std::mt19937_64 random(4);
        std::vector<Obb> a, b;
        for (int i = 0; i < 20000; ++i) {
            a.push_back(random_box(random));
            b.push_back(random_box(random, 2.0));
        }
        std::vector<std::uint8_t> hits(a.size());
        CHECK(intersects(a, b, hits).refined < a.size() / 500);
    }
}
