// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/triangulate/triangulate.hpp>
#include <ctime>
#include <error_of.hpp>
#include <filesystem>
#include <glm/geometric.hpp>
#include <oracle/minimum_weight.hpp>
#include <oracle/triangulation_check.hpp>

#include "polygons.hpp"

using namespace crofton;
using namespace crofton::test;

namespace {

// However slow the machine.
const triangulate::TriangulateOptions kUnhurried{.work = triangulate::TriangulateOptions::kUnlimitedWork};

// Empty if the result is conforming, claims to be optimal and has the reference's weight.
std::string compare(const Polygon& polygon, triangulate::Triangulator& triangulator) {
    triangulate::Triangulation result;
    const auto done = triangulator.triangulate(polygon, kUnhurried, result);
    if (!done) return done.error().message;
    if (!result.optimal || result.gap != 0.0) return "not optimal";
    if (const auto wrong = oracle::check_triangulation(polygon, result.triangles); !wrong.empty()) return wrong;
    const auto truth = static_cast<double>(oracle::MinimumWeightReference(polygon).solve());
    if (std::fabs(result.weight - truth) > 1e-12 * truth) {
        return "weight " + std::to_string(result.weight) + " instead of " + std::to_string(truth);
    }
    return "";
}

bool is_valid(const Polygon& polygon) {
    return triangulate::triangulate(polygon, {.method = triangulate::Method::delaunay}).has_value();
}

}  // namespace

TEST_SUITE("triangulate/minimum_weight") {
    TEST_CASE("a quadrilateral takes its shorter diagonal") {
        const auto result = triangulate::triangulate(polygon({{{0, 0}, {4, -1}, {8, 0}, {4, 1}}})).value();
        CHECK(result.weight == 2.0);
        CHECK(result.optimal);
    }

    TEST_CASE("a ring that goes round twice is not convex, though each corner turns to one side") {
        // Found by fuzz_triangulate: its second round touches the first one, and cuts a triangle out of it.
        const Polygon p = polygon({{{-0.125, 0}, {0, 5}, {5, -0.125}, {0, 0}, {0, 1}, {1.5, 0}}});
        for (const auto method :
             {triangulate::Method::ear, triangulate::Method::delaunay, triangulate::Method::minimum_weight}) {
            const auto result = triangulate::triangulate(p, {.method = method}).value();
            CHECK(result.triangles.size() == 5);
            CHECK(oracle::check_triangulation(p, result.triangles, true) == "");
        }
    }

    TEST_CASE("minimum weight beats Delaunay on the flat kite of five points") {
        // Checked by hand: the pentagon has five triangulations, each two diagonals from one corner.
        const glm::dvec2 p[] = {{0, 0}, {10, 0}, {11, 3}, {5, 4}, {-1, 3}};
        double best = 1e9;
        for (int corner = 0; corner < 5; ++corner) {
            best = std::min(
                best, glm::distance(p[corner], p[(corner + 2) % 5]) + glm::distance(p[corner], p[(corner + 3) % 5]));
        }
        const auto result = triangulate::triangulate(polygon({{p[0], p[1], p[2], p[3], p[4]}})).value();
        CHECK(result.weight == doctest::Approx(best).epsilon(1e-15));
    }

    TEST_CASE("regular polygons, where everything ties") {
        triangulate::Triangulator triangulator;
        for (int n = 3; n <= 24; ++n) {
            Polygon p;
            for (int i = 0; i < n; ++i) {
                p.points.emplace_back(1000.0 * std::cos(6.283185307179586 * i / n),
                                      1000.0 * std::sin(6.283185307179586 * i / n));
            }
            p.ring_ends = {static_cast<std::uint32_t>(n)};
            CHECK(compare(p, triangulator) == "");
        }
    }

    TEST_CASE("combs and stairs on a grid, where sums of different roots tie") {
        triangulate::Triangulator triangulator;
        for (int steps = 1; steps <= 8; ++steps) {
            Polygon stairs;
            for (int i = 0; i <= steps; ++i) {
                stairs.points.emplace_back(i, i);
                stairs.points.emplace_back(i + 1, i);
            }
            stairs.points.emplace_back(steps + 1, steps + 1);
            stairs.points.emplace_back(0, steps + 1);
            stairs.ring_ends = {static_cast<std::uint32_t>(stairs.points.size())};
            CHECK(compare(stairs, triangulator) == "");
        }
    }

    TEST_CASE("vertices hidden behind walls exclude nothing: an S with vertices on its outer arms") {
        // Every long diagonal of the middle arm has (10, 1) and (10, 3) in its diamond, behind the walls; one of them
        // is needed.
        const auto s = polygon({{{0, 0},
                                 {21, 0},
                                 {21, 2.5},
                                 {1, 2.5},
                                 {1, 3},
                                 {10, 3},
                                 {21, 3},
                                 {21, 4},
                                 {0, 4},
                                 {0, 1.5},
                                 {20, 1.5},
                                 {20, 1},
                                 {10, 1},
                                 {0, 1}}});
        triangulate::Triangulator triangulator;
        CHECK(compare(s, triangulator) == "");
    }

    TEST_CASE("agrees with the unpruned programme on random simple polygons, on and off grids") {
        std::mt19937_64 random(21);
        triangulate::Triangulator triangulator;
        int compared = 0;
        for (int trial = 0; trial < 2500; ++trial) {
            Polygon p;
            const double grid = trial % 3 == 0 ? 1.0 : trial % 3 == 1 ? 64.0 : 0.0;
            add_star(p, random, {0, 0}, 1.0 + trial % 9, 10.0, 4 + trial % 33, grid);
            if (!is_valid(p) || triangulate::triangulate(p)->triangles.size() + 2 != p.points.size()) continue;
            ++compared;
            REQUIRE(compare(p, triangulator) == "");
        }
        CHECK(compared > 1500);
    }

    TEST_CASE("agrees with the unpruned search on random polygons with one to three holes") {
        std::mt19937_64 random(22);
        triangulate::Triangulator triangulator;
        int compared = 0;
        for (int trial = 0; trial < 600; ++trial) {
            Polygon p;
            const double grid = trial % 3 == 0 ? 2.0 : 0.0;
            const int holes = 1 + (trial % 7 == 0) + (trial % 14 == 0);
            add_star(p, random, {0, 0}, 5.0, 10.0, 4 + trial % 9, grid);
            add_star(p, random, {-2.2, 0.3}, 0.3, 0.7 + trial % 4 * 0.4, 3 + trial % 3, grid);
            if (holes > 1) add_star(p, random, {2.2, -0.4}, 0.3, 0.9, 3 + trial % 2, grid);
            if (holes > 2) add_star(p, random, {0.1, 2.4}, 0.3, 0.9, 3, grid);
            const auto result = triangulate::triangulate(p, {.method = triangulate::Method::delaunay});
            if (!result || result->triangles.size() != p.points.size() - 2 + 2 * static_cast<std::size_t>(holes))
                continue;
            ++compared;
            INFO(trial);
            REQUIRE(compare(p, triangulator) == "");
        }
        CHECK(compared > 400);
    }

    TEST_CASE("turning the plane by right angles changes no weight, also where holes hang far from all else") {
        std::mt19937_64 random(33);
        std::uniform_real_distribution<double> unit(-1.0, 1.0);
        for (int trial = 0; trial < 150; ++trial) {
            CAPTURE(trial);
            Polygon p;
            add_star(p, random, {0, 0}, 9.0, 10.0, 30 + trial % 60, 0.0);
            for (int hole = 0; hole < 2 + trial % 5; ++hole) {
                const double angle = 6.283185307179586 * (hole + 0.3 * unit(random)) / (2 + trial % 5);
                add_star(p, random, 4.5 * glm::dvec2(std::cos(angle), std::sin(angle)), 0.1, 1.0, 3 + trial % 3, 0.0);
            }
            const auto first = triangulate::triangulate(p, kUnhurried).value();
            for (int turn = 0; turn < 3; ++turn) {
                for (auto& q : p.points) q = glm::dvec2(-q.y, q.x);
                const auto turned = triangulate::triangulate(p, kUnhurried).value();
                CHECK(turned.optimal);
                CHECK(std::fabs(turned.weight - first.weight) <= 1e-12 * first.weight);
            }
        }
    }

    TEST_CASE("without work, time or memory nothing heavier than ear clipping and Delaunay is returned") {
        std::mt19937_64 random(23);
        for (int trial = 0; trial < 40; ++trial) {
            CAPTURE(trial);
            Polygon p;
            add_star(p, random, {0, 0}, 5.0, 10.0, 20 + 15 * trial, trial % 2 ? 8.0 : 0.0);
            add_star(p, random, {0.5, 0.3}, 0.5, 3.0, 5 + trial, 0.0);
            if (trial % 3 == 0) {
                p.points.insert(p.points.end(), {{3.5, 0.4}, {3.6, 0.1}, {-3.5, 0.3}});
                p.ring_ends.insert(p.ring_ends.end(), {p.ring_ends.back() + 2, p.ring_ends.back() + 3});
            }
            const auto ear = triangulate::triangulate(p, {.method = triangulate::Method::ear});
            const auto delaunay = triangulate::triangulate(p, {.method = triangulate::Method::delaunay});
            const auto minimum = triangulate::triangulate(p, kUnhurried);
            // On the grid rings may touch themselves with a tip outside, which no triangle uses.
            if (!delaunay || oracle::check_triangulation(p, delaunay->triangles) != "") continue;
            REQUIRE(ear.has_value());
            REQUIRE(minimum.has_value());
            for (const auto& options :
                 {triangulate::TriangulateOptions{.work = 0}, triangulate::TriangulateOptions{.seconds = 0.0},
                  triangulate::TriangulateOptions{.bytes = 1000}}) {
                const auto result = triangulate::triangulate(p, options).value();
                CHECK(oracle::check_triangulation(p, result.triangles) == "");
                CHECK_FALSE(result.optimal);
                CHECK(result.weight <= std::min(ear->weight, delaunay->weight) * (1.0 + 1e-14));
                CHECK(result.weight >= minimum->weight * (1.0 - 1e-12));
                CHECK(result.weight <= minimum->weight * (1.0 + result.gap));
                CHECK(std::isfinite(result.gap));
            }
        }
    }

    TEST_CASE("without work a polygon that fits into one window still gets its minimum") {
        std::mt19937_64 random(41);
        int compared = 0;
        for (int trial = 0; trial < 400; ++trial) {
            CAPTURE(trial);
            Polygon p;
            add_star(p, random, {0, 0}, 1.0 + trial % 9, 10.0, 4 + trial % 40, trial % 2 ? 16.0 : 0.0);
            const auto result = triangulate::triangulate(p, {.work = 0});
            if (!result || result->triangles.size() + 2 != p.points.size()) continue;
            ++compared;
            const auto truth = static_cast<double>(oracle::MinimumWeightReference(p).solve());
            CHECK(oracle::check_triangulation(p, result->triangles) == "");
            CHECK(std::fabs(result->weight - truth) <= 1e-12 * truth);
        }
        CHECK(compared > 250);
    }

    TEST_CASE("a limit of work gives the same triangles in every run, and a true bound on the minimum") {
        std::mt19937_64 random(34);
        Polygon p;
        add_star(p, random, {0, 0}, 9.0, 10.0, 500, 0.0);
        for (int hole = 0; hole < 8; ++hole) {
            const double angle = 6.283185307179586 * hole / 8;
            add_star(p, random, 5.0 * glm::dvec2(std::cos(angle), std::sin(angle)), 0.8, 1.0, 40, 0.0);
        }
        const auto minimum = triangulate::triangulate(p, kUnhurried).value();
        REQUIRE(minimum.optimal);
        triangulate::Triangulator warm;
        triangulate::Triangulation again;
        int limited = 0, proven = 0;
        for (std::uint64_t work = 1; work < 100'000'000; work += work / 2 + 1) {
            const auto result = triangulate::triangulate(p, {.work = work}).value();
            REQUIRE(warm.triangulate(p, {.work = work}, again).has_value());
            CHECK(again.triangles == result.triangles);
            CHECK(again.gap == result.gap);
            (result.optimal ? proven : limited) += 1;
            CHECK(oracle::check_triangulation(p, result.triangles) == "");
            CHECK(result.weight >= minimum.weight * (1.0 - 1e-12));
            CHECK(result.weight <= minimum.weight * (1.0 + result.gap) * (1.0 + 1e-12));
            CHECK(result.optimal == (result.gap == 0.0));
        }
        CHECK(limited > 10);
        CHECK(proven > 3);
    }

    TEST_CASE("convex rings in either orientation, irregular, alike in four quarters to the bit, and on grids") {
        std::mt19937_64 random(42);
        std::uniform_real_distribution<double> unit(0.0, 1.0);
        triangulate::Triangulator triangulator;
        for (int trial = 0; trial < 60; ++trial) {
            CAPTURE(trial);
            std::vector<glm::dvec2> quarter, points;
            const int count = 1 + trial % 12;
            for (int i = 0; i < count; ++i) {
                const double angle = 1.5707963267948966 * (i + 0.1 + 0.8 * unit(random)) / count;
                quarter.emplace_back(10.0 * std::cos(angle), (trial % 2 ? 10.0 : 4.0) * std::sin(angle));
            }
            for (int turn = 0; turn < 4; ++turn) {
                for (auto& q : quarter) {
                    points.push_back(q);
                    q = glm::dvec2(-q.y, q.x);
                }
            }
            if (trial % 3 == 0) std::reverse(points.begin(), points.end());
            Polygon p;
            p.points.assign(points.begin(), points.end());
            p.ring_ends = {static_cast<std::uint32_t>(points.size())};
            if (!is_valid(p)) continue;
            CHECK(compare(p, triangulator) == "");
        }
        // All grid points of a circle: 3² + 4² = 5² and so on tie across different directions.
        Polygon circle;
        std::vector<glm::dvec2> on;
        for (int x = -65; x <= 65; ++x)
            for (int y = -65; y <= 65; ++y)
                if (x * x + y * y == 65 * 65) on.emplace_back(x, y);
        std::sort(on.begin(), on.end(),
                  [](const glm::dvec2& a, const glm::dvec2& b) { return std::atan2(a.y, a.x) < std::atan2(b.y, b.x); });
        circle.points.assign(on.begin(), on.end());
        circle.ring_ends = {static_cast<std::uint32_t>(on.size())};
        CHECK(on.size() == 36);
        CHECK(compare(circle, triangulator) == "");
    }

    TEST_CASE("whenever time runs out, there is a triangulation and a true bound on the minimum") {
        std::mt19937_64 random(31);
        Polygon p;
        add_star(p, random, {0, 0}, 9.0, 10.0, 700, 0.0);
        for (int hole = 0; hole < 12; ++hole) {
            const double angle = 6.283185307179586 * hole / 12;
            add_star(p, random, 5.0 * glm::dvec2(std::cos(angle), std::sin(angle)), 0.8, 1.0, 60, 0.0);
        }
        const auto minimum = triangulate::triangulate(p, kUnhurried).value();
        REQUIRE(minimum.optimal);
        int limited = 0;
        for (double seconds = 1e-5; seconds < 2.0; seconds *= 1.5) {
            const auto result = triangulate::triangulate(p, {.seconds = seconds}).value();
            limited += !result.optimal;
            CHECK(oracle::check_triangulation(p, result.triangles) == "");
            CHECK(result.weight >= minimum.weight * (1.0 - 1e-12));
            CHECK(result.weight <= minimum.weight * (1.0 + result.gap) * (1.0 + 1e-12));
            CHECK(result.optimal == (result.gap == 0.0));
        }
        CHECK(limited > 0);
    }

    TEST_CASE("a limit of 0.05 s is kept but for what is returned to be improved, and the gap is finite") {
        std::mt19937_64 random(32);
        Polygon rough, round;
        add_star(rough, random, {0, 0}, 9.0, 10.0, 30'000, 0.0);
        add_star(round, random, {0, 0}, 10.0, 10.0, 30'000, 0.0);
        for (const Polygon& p : {rough, round}) {
            // Processor time: other programs may run meanwhile.
            const auto timed = [&](const triangulate::TriangulateOptions& options) {
                const std::clock_t start = std::clock();
                const auto result = triangulate::triangulate(p, options);
                const double taken = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
                REQUIRE(result.has_value());
                CHECK_FALSE(result->optimal);
                CHECK(result->gap > 0.0);
                CHECK(result->gap < 50.0);
                return taken;
            };
            const double improving = timed({.work = 0});
            CHECK(timed({.seconds = 0.05}) < 1.5 * improving + 0.5);  // 0.3 s and 0.05
        }
    }

    TEST_CASE("the stop callback sees growing shares and can cancel") {
        std::mt19937_64 random(24);
        Polygon p;
        add_star(p, random, {0, 0}, 5.0, 10.0, 2000, 0.0);
        struct State {
            double last = -1.0;
            int calls = 0, allowed = 1 << 30;
        } state;
        triangulate::TriangulateOptions options;
        options.user = &state;
        options.should_stop = [](void* user, double fraction) {
            auto& s = *static_cast<State*>(user);
            CHECK(fraction >= s.last);
            CHECK(fraction <= 1.0);
            s.last = fraction;
            return ++s.calls >= s.allowed;
        };
        CHECK(triangulate::triangulate(p, options).has_value());
        CHECK(state.calls > 10);
        state = {.allowed = 5};
        const auto result = triangulate::triangulate(p, options);
        CHECK(error_of(result).code == ErrorCode::cancelled);
        CHECK(state.calls == 5);
    }

    TEST_CASE("agrees with the unpruned programme on real level sectors and glyphs without holes") {
        const std::string folder = std::string(CROFTON_SHARED_DATA) + "/polygons/";
        if (!std::filesystem::exists(folder)) return;
        triangulate::Triangulator triangulator;
        for (const char* file : {"doom.poly", "glyphs.poly", "counties10.poly"}) {
            std::size_t index = 0;
            for (const auto& [name, p] : read_poly_file(folder + file)) {
                if (index++ % 23 != 0 || p.ring_count() != 1 || p.points.size() > 48 || name == "Hardin") continue;
                std::set<oracle::Point> distinct;
                for (const auto& q : p.points) distinct.insert({q.x, q.y});
                if (distinct.size() != p.points.size() || !is_valid(p)) continue;
                const std::string polygon = name;
                INFO(polygon);
                CHECK(compare(p, triangulator) == "");
            }
        }
    }
}
