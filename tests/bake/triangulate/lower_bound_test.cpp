// SPDX-License-Identifier: MIT
// The proven lower bound where it is tight: a bound that is a hair too high is no bound.
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/triangulate/triangulate.hpp>
#include <oracle/minimum_weight.hpp>

#include "polygons.hpp"

using namespace crofton;
using namespace crofton::test;
using triangulate::TriangulateOptions;

namespace {

double lower_bound_of(const triangulate::Triangulation& result) {
    return result.weight / (1.0 + result.gap);
}

// Two rows of points, between which every diagonal of the zigzag is 5 long: no diagonal is shorter.
Polygon strip(int count) {
    Polygon p;
    for (int i = 0; i < count; ++i) p.points.emplace_back(6.0 * i, 0.0);
    for (int i = count - 1; i >= 0; --i) p.points.emplace_back(6.0 * i + 3.0, 4.0);
    p.ring_ends = {static_cast<std::uint32_t>(p.points.size())};
    return p;
}

// A finely divided wavy ring with wavy holes around `count` places within.
Polygon wavy(std::mt19937_64& random, int points, int count) {
    Polygon p;
    const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    const auto add = [&](glm::dvec2 center, double radius, int n) {
        const double phase = 6.0 * unit(), waves = 2.0 + std::floor(4.0 * unit()), depth = 0.1 + 0.2 * unit();
        for (int i = 0; i < n; ++i) {
            const double a = 2.0 * 3.141592653589793 * i / n;
            const double r = radius * (1.0 + depth * std::sin(waves * a + phase)) * (1.0 + 1e-3 * unit());
            p.points.push_back(center + r * glm::dvec2(std::cos(a), std::sin(a)));
        }
        p.ring_ends.push_back(static_cast<std::uint32_t>(p.points.size()));
    };
    add({0, 0}, 10.0, points);
    for (int k = 0; k < count; ++k) {
        const double a = 2.0 * 3.141592653589793 * k / count;
        add(4.5 * glm::dvec2(std::cos(a), std::sin(a)), 0.6 + 0.5 * unit(), points / 8);
    }
    return p;
}

}  // namespace

TEST_SUITE("triangulate/lower bound") {
    TEST_CASE("if all diagonals are the shortest, the bound is the minimum and no more") {
        for (const int count : {2, 3, 7, 40, 300})
            for (const TriangulateOptions& options : {TriangulateOptions{.work = 0}, TriangulateOptions{.seconds = 0.0},
                                                      TriangulateOptions{.bytes = 100}}) {
                const auto result = triangulate::triangulate(strip(count), options).value();
                const double minimum = 5.0 * (2.0 * count - 3.0);
                CHECK(result.weight == doctest::Approx(minimum).epsilon(1e-12));
                CHECK(lower_bound_of(result) <= minimum);
                CHECK(result.gap < 1e-9);
            }
    }

    TEST_CASE("with any amount of work, the bound is never above the minimum") {
        for (const int count : {7, 40}) {
            const double minimum = 5.0 * (2.0 * count - 3.0);
            int tight = 0;
            for (double work = 1.0; work < 1e6; work *= 1.1) {
                const auto result =
                    triangulate::triangulate(strip(count), {.work = static_cast<std::uint64_t>(work)}).value();
                CHECK(lower_bound_of(result) <= minimum);
                tight += !result.optimal && lower_bound_of(result) > minimum * (1.0 - 1e-9);
            }
            CHECK(tight > 50);
        }
    }

    TEST_CASE("no bound of a small polygon is above its minimum, however little is known") {
        std::mt19937_64 random(51);
        int compared = 0, tight = 0;
        for (int trial = 0; trial < 4000; ++trial) {
            CAPTURE(trial);
            Polygon p;
            add_star(p, random, {0, 0}, 1.0 + trial % 9, 10.0, 4 + trial % 6, trial % 2 ? 4.0 : 0.0);
            const auto result = triangulate::triangulate(p, {.seconds = 0.0});
            if (!result || result->triangles.size() + 2 != p.points.size()) continue;
            const auto truth = static_cast<double>(oracle::MinimumWeightReference(p).solve());
            REQUIRE(lower_bound_of(*result) <= truth * (1.0 + 1e-15));
            ++compared;
            tight += lower_bound_of(*result) > truth * (1.0 - 1e-6);
        }
        CHECK(compared > 2000);
        CHECK(tight > 100);
    }

    TEST_CASE("on wavy rings with holes no work, time or memory gives a bound above the minimum") {
        std::mt19937_64 random(71);
        for (int trial = 0; trial < 10; ++trial) {
            CAPTURE(trial);
            const Polygon p = wavy(random, 40 + 16 * trial, trial % 4);
            const auto minimum = triangulate::triangulate(p, {.work = TriangulateOptions::kUnlimitedWork}).value();
            REQUIRE(minimum.optimal);
            const auto check = [&](const TriangulateOptions& options) {
                const auto result = triangulate::triangulate(p, options).value();
                CHECK(lower_bound_of(result) <= minimum.weight * (1.0 + 1e-14));
            };
            check({.seconds = 0.0});
            check({.bytes = 100});
            for (double work = 1.0; work < 3e6; work *= 2.3) check({.work = static_cast<std::uint64_t>(work)});
        }
    }

    TEST_CASE("for finely divided boundaries the bound is far above that of the shortest diagonals") {
        // A comb: slots 1 wide and 12 long, whose sides are divided finely.
        Polygon p;
        constexpr int kSlots = 12, kSteps = 120;
        for (int slot = 0; slot < kSlots; ++slot) {
            for (int i = 0; i < kSteps; ++i) p.points.emplace_back(2.0 * slot, 12.0 * i / kSteps);
            for (int i = kSteps; i > 0; --i) p.points.emplace_back(2.0 * slot + 1.0, 12.0 * i / kSteps);
        }
        p.points.emplace_back(2.0 * kSlots - 1.0, -1.0);
        p.points.emplace_back(0.0, -1.0);
        p.ring_ends = {static_cast<std::uint32_t>(p.points.size())};
        const auto minimum = triangulate::triangulate(p, {}).value();
        REQUIRE(minimum.optimal);
        for (const std::uint64_t work : {std::uint64_t{0}, std::uint64_t{100'000}}) {
            const auto result = triangulate::triangulate(p, {.work = work}).value();
            MESSAGE("gap " << result.gap << " with work " << work);
            CHECK(lower_bound_of(result) <= minimum.weight * (1.0 + 1e-14));
            CHECK(result.gap < 0.6);
        }
    }

    TEST_CASE("rectangles in a row, each with two diagonals of one length, are promised one of them") {
        for (const int count : {6, 30}) {
            Polygon p;
            for (int i = 0; i < count; ++i) p.points.emplace_back(6.0 * i, 0.0);
            for (int i = count - 1; i >= 0; --i) p.points.emplace_back(6.0 * i, 8.0);
            p.ring_ends = {static_cast<std::uint32_t>(p.points.size())};
            const double minimum = 8.0 * (count - 2) + 10.0 * (count - 1);
            int tight = 0;
            for (double work = 1.0; work < 1e6; work *= 1.05) {
                const auto result = triangulate::triangulate(p, {.work = static_cast<std::uint64_t>(work)}).value();
                CHECK(lower_bound_of(result) <= minimum * (1.0 + 1e-15));
                tight += !result.optimal && lower_bound_of(result) > minimum * (1.0 - 1e-9);
            }
            CHECK(tight > 4);
        }
    }

    TEST_CASE(
        "the faces that are left unsolved are bounded by their own diagonals, tightly where these are all alike") {
        // A strip with a triangular hole in its middle, given work for some of its parts only.
        Polygon p;
        for (int i = 0; i < 12; ++i) p.points.emplace_back(6.0 * i, 0.0);
        for (int i = 11; i >= 0; --i) p.points.emplace_back(6.0 * i + 3.0, 8.0);
        p.ring_ends = {24};
        p.points.insert(p.points.end(), {{30.0, 4.0}, {33.0, 5.0}, {36.0, 4.0}});
        p.ring_ends.push_back(27);
        const auto minimum = triangulate::triangulate(p, {}).value();
        REQUIRE(minimum.optimal);
        for (std::uint64_t work = 0; work < 3000; work += 1 + work / 8) {
            const auto result = triangulate::triangulate(p, {.work = work}).value();
            CHECK(lower_bound_of(result) <= minimum.weight * (1.0 + 1e-15));
        }
    }
}
