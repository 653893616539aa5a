// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <chrono>
#include <crofton/triangulate/triangulate.hpp>
#include <oracle/triangulation_check.hpp>

#include "polygons.hpp"

using namespace crofton;
using namespace crofton::test;
using triangulate::Method;

namespace {

Polygon square(double low, double high) {
    return polygon({{{low, low}, {high, low}, {high, high}, {low, high}}});
}

void add_ring(Polygon& polygon, std::initializer_list<glm::dvec2> ring) {
    polygon.points.insert(polygon.points.end(), ring);
    polygon.ring_ends.push_back(static_cast<std::uint32_t>(polygon.points.size()));
}

std::string checked(const Polygon& polygon) {
    const auto result = triangulate::triangulate(polygon, {.method = Method::delaunay});
    if (!result) return result.error().message;
    if (!oracle::is_constrained_delaunay(polygon, result->triangles)) return "not constrained Delaunay";
    return oracle::check_triangulation(polygon, result->triangles);
}

// Teeth one above the other: all points but three lie on two verticals.
Polygon comb(int teeth) {
    Polygon result;
    result.points = {{0.0, 2.0 * teeth}, {0.0, 0.0}};
    for (int i = 0; i < teeth; ++i) {
        result.points.emplace_back(100.0, 2.0 * i);
        result.points.emplace_back(1.0, 2.0 * i + 1.0);
    }
    result.points.emplace_back(100.0, 2.0 * teeth);
    result.ring_ends = {static_cast<std::uint32_t>(result.points.size())};
    return result;
}

}  // namespace

TEST_SUITE("triangulate/delaunay") {
    TEST_CASE("point sets of any size and any degeneracy within a square, each point a hole") {
        std::mt19937_64 random(21);
        std::uniform_real_distribution<double> unit(-1.0, 1.0);
        for (int trial = 0; trial < 240; ++trial) {
            CAPTURE(trial);
            std::set<std::pair<double, double>> points;
            const int count = 1 + trial / 2;
            for (int i = 0; i < count; ++i) {
                const double x = unit(random), y = unit(random);
                switch (trial % 8) {
                    case 0:
                        points.emplace(x, y);
                        break;
                    case 1:
                        points.emplace(std::round(4.0 * x), std::round(4.0 * y));
                        break;
                    case 2:
                        points.emplace(0.5, i);
                        break;
                    case 3:
                        points.emplace(i, 0.5);
                        break;
                    case 4:
                        points.emplace(i % 2, i / 2);
                        break;
                    case 5:
                        points.emplace(std::cos(i), std::sin(i));
                        break;
                    case 6:
                        points.emplace(std::ldexp(x, -(i % 40)), std::ldexp(y, -(i % 40)));
                        break;
                    default:
                        points.emplace(i, i);
                        break;
                }
            }
            Polygon p = square(-200.0, 200.0);
            for (const auto& [x, y] : points) add_ring(p, {{x, y}});
            CHECK(checked(p) == "");
        }
    }

    TEST_CASE("random stars with holes, whose edges must be forced in") {
        std::mt19937_64 random(22);
        for (int trial = 0; trial < 60; ++trial) {
            CAPTURE(trial);
            Polygon p;
            add_star(p, random, {0, 0}, 4.0, 40.0, 20 + 10 * trial, 0.0);
            add_star(p, random, {-1.5, 0}, 0.2, 1.4, 3 + trial % 50, 0.0);
            add_star(p, random, {1.5, 0.1}, 0.2, 1.4, 3 + trial % 40, 0.0);
            CHECK(checked(p) == "");
        }
    }

    TEST_CASE("a hole anywhere gives the answer of a polygon whose rings share a point") {
        // A point that two rings share makes the general search for the inside run, where the simple one would do.
        std::mt19937_64 random(23);
        std::uniform_real_distribution<double> unit(0.0, 1.0);
        int refused = 0;
        for (int trial = 0; trial < 200; ++trial) {
            CAPTURE(trial);
            Polygon simple = square(0.0, 20.0), shared = simple;
            shared.points[3] = {0.0, 20.0};
            add_ring(simple, {{0.5, 19.0}, {1.0, 19.0}, {1.0, 19.5}});
            add_ring(shared, {{0.0, 20.0}, {1.0, 19.0}, {1.0, 19.5}});
            for (int h = 0; h < 3; ++h) {
                const glm::dvec2 at(24.0 * unit(random), 17.0 * unit(random));
                const double size = 0.2 + 4.0 * unit(random) * unit(random);
                for (Polygon* p : {&simple, &shared}) {
                    add_ring(*p,
                             {at, at + glm::dvec2(size, 0.1), at + glm::dvec2(size, size), at + glm::dvec2(0.1, size)});
                    if (trial % 2) std::reverse(p->points.end() - 4, p->points.end());
                }
            }
            const auto a = triangulate::triangulate(simple, {.method = Method::delaunay});
            const auto b = triangulate::triangulate(shared, {.method = Method::delaunay});
            REQUIRE(a.has_value() == b.has_value());
            refused += !a;
            if (!a) continue;
            CHECK(checked(simple) == "");
            CHECK(a->triangles.size() == b->triangles.size() + 2);
        }
        CHECK(refused > 40);
        CHECK(refused < 160);
    }

    TEST_CASE("50,000 points on two verticals, on one line, on a grid: no quadratic time") {
        std::vector<Polygon> hard{comb(25'000)};
        Polygon line = polygon({{{-1.0, -1.0}, {1.0, -1.0}, {1.0, 50'000.0}, {-1.0, 50'000.0}}}),
                grid = square(-1.0, 224.0);
        for (int i = 0; i < 50'000; ++i) add_ring(line, {{0.0, i}});
        for (int i = 0; i < 224 * 224; ++i) add_ring(grid, {{i % 224, i / 224}});
        hard.push_back(line);
        hard.push_back(grid);
        const auto start = std::chrono::steady_clock::now();
        for (const Polygon& p : hard) {
            const auto result = triangulate::triangulate(p, {.method = Method::delaunay}).value();
            const std::size_t holes = p.ring_count() - 1;
            CHECK(result.triangles.size() == p.points.size() - 2 + (holes == 0 ? 0 : holes));
        }
        // 0.05 s of one idle core each; where the time grows as the square, many seconds.
        CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() < 10.0);
    }
}
