// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/triangulate/triangulate.hpp>
#include <error_of.hpp>
#include <filesystem>
#include <limits>
#include <oracle/triangulation_check.hpp>

#include "polygons.hpp"

using namespace crofton;
using namespace crofton::test;
using triangulate::Method;

namespace {

std::string checked(const Polygon& polygon, Method method, bool weakly_simple = false) {
    const auto result = triangulate::triangulate(polygon, {.method = method});
    if (!result) return result.error().message;
    const double weight = oracle::diagonal_length(polygon, result->triangles);
    if (std::fabs(weight - result->weight) > 1e-12 * weight) return "the weight is not the diagonals' length";
    return oracle::check_triangulation(polygon, result->triangles, weakly_simple);
}

ErrorCode code(const Polygon& polygon) {
    const auto result = triangulate::triangulate(polygon);
    REQUIRE_FALSE(result.has_value());
    return result.error().code;
}

constexpr Method kMethods[] = {Method::ear, Method::delaunay, Method::minimum_weight};

}  // namespace

TEST_SUITE("triangulate/triangulate") {
    TEST_CASE("fewer than three points are an error") {
        CHECK(code(Polygon{}) == ErrorCode::empty);
        CHECK(code(polygon({{{0, 0}, {1, 0}}})) == ErrorCode::empty);
        CHECK(code(polygon({{}, {{0, 0}, {1, 0}, {0, 1}}})) == ErrorCode::empty);
    }

    TEST_CASE("NaN and infinity are named with their index") {
        const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
        for (const double bad : {nan, infinity, -infinity}) {
            auto p = polygon({{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {{1, 1}, {2, 1}, {2, 2}}});
            p.points[5].y = bad;
            const auto result = triangulate::triangulate(p);
            REQUIRE_FALSE(result.has_value());
            CHECK(error_of(result).code == ErrorCode::non_finite);
            CHECK(error_of(result).item == 5);
        }
    }

    TEST_CASE("ring ends that do not fit the points are an error") {
        auto p = polygon({{{0, 0}, {4, 0}, {4, 4}}});
        p.ring_ends = {5};
        CHECK(code(p) == ErrorCode::invalid_argument);
        p.ring_ends = {3, 2};
        CHECK(code(p) == ErrorCode::invalid_argument);
        p.ring_ends = {2};
        CHECK(code(p) == ErrorCode::invalid_argument);
    }

    TEST_CASE("zero area is an error: collinear points, a ring there and back, a hole that fills everything") {
        CHECK(code(polygon({{{0, 0}, {1, 1}, {2, 2}, {3, 3}}})) == ErrorCode::degenerate);
        CHECK(code(polygon({{{0, 0}, {1, 1}, {2, 0}, {1, 1}}})) == ErrorCode::degenerate);
        CHECK(code(polygon({{{0, 0}, {0, 0}, {0, 0}}})) == ErrorCode::degenerate);
        CHECK(code(polygon({{{0, 0}, {4, 0}, {4, 4}}, {{0, 0}, {4, 0}, {4, 4}}})) == ErrorCode::degenerate);
    }

    TEST_CASE("edges that cross are an error naming both") {
        const auto result = triangulate::triangulate(polygon({{{0, 0}, {2, 2}, {2, 0}, {0, 2}}}));
        REQUIRE_FALSE(result.has_value());
        CHECK(error_of(result).code == ErrorCode::degenerate);
        CHECK(error_of(result).message.find("crosses") != std::string::npos);
        CHECK(code(polygon({{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {{2, 2}, {6, 2}, {6, 3}, {2, 3}}})) ==
              ErrorCode::degenerate);
    }

    TEST_CASE("holes outside, nested, equal or overlapping are errors") {
        const auto with = [](std::initializer_list<glm::dvec2> a, std::initializer_list<glm::dvec2> b) {
            return polygon({{{0, 0}, {10, 0}, {10, 10}, {0, 10}}, a, b});
        };
        CHECK(code(with({{11, 1}, {12, 1}, {12, 2}}, {{1, 1}, {2, 1}, {2, 2}})) == ErrorCode::degenerate);
        CHECK(code(with({{1, 1}, {8, 1}, {8, 8}}, {{4, 2}, {5, 2}, {5, 3}})) == ErrorCode::degenerate);
        CHECK(code(with({{1, 1}, {8, 1}, {8, 8}}, {{1, 1}, {8, 1}, {8, 8}})) == ErrorCode::degenerate);
        CHECK(code(with({{1, 1}, {8, 1}, {8, 8}}, {{1, 1}, {8, 1}, {8, 4}})) == ErrorCode::degenerate);
        CHECK(code(with({{20, 20}}, {{1, 1}, {8, 1}, {8, 4}})) == ErrorCode::degenerate);
        CHECK(code(with({{6, 2}}, {{1, 1}, {8, 1}, {8, 4}})) == ErrorCode::degenerate);
    }

    TEST_CASE("a hole outside is an error even if no triangle of the Delaunay triangulation is left next to it") {
        CHECK(code(polygon({{{3, 2}, {2, 2}, {6, 8}, {7, 4}}, {{0, 0}, {4, 0}, {7, 3}}})) == ErrorCode::degenerate);
        CHECK(code(polygon({{{0, 1}, {12, 1}, {16, 2}, {15, 2}}, {{2, 0}, {0, 0}, {13, 1}}})) == ErrorCode::degenerate);
    }

    TEST_CASE("the error for nested holes names an edge of the inner one, whichever point comes first") {
        const std::vector<glm::dvec2> outer = {{1, 1}, {8, 1}, {8, 8}}, inner = {{4, 2}, {5, 2}, {5, 3}};
        for (std::size_t first = 0; first < 3; ++first)
            for (const bool outer_comes_first : {false, true}) {
                Polygon p = polygon({{{0, 0}, {10, 0}, {10, 10}, {0, 10}}});
                for (const auto* hole : {outer_comes_first ? &outer : &inner, outer_comes_first ? &inner : &outer}) {
                    for (std::size_t i = 0; i < 3; ++i) p.points.push_back((*hole)[(first + i) % 3]);
                    p.ring_ends.push_back(static_cast<std::uint32_t>(p.points.size()));
                }
                const std::uint64_t begin = outer_comes_first ? 7 : 4;  // of the inner hole's three points
                const auto result = triangulate::triangulate(p);
                REQUIRE_FALSE(result.has_value());
                CHECK(error_of(result).item >= begin);
                CHECK(error_of(result).item < begin + 3);
                CHECK(error_of(result).message.find("holes 1 and 2 overlap or lie inside one another") !=
                      std::string::npos);
            }
    }

    TEST_CASE("coordinates of any size work, too different ones are an error") {
        for (const double scale : {1e-300, 1e-155, 1e-12, 1.0, 1e12, 1e155, 1e300}) {
            auto p = polygon({{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {{1, 1}, {2, 1}, {2, 2}}});
            for (auto& q : p.points) q *= scale;
            for (const Method method : kMethods) {
                const auto result = triangulate::triangulate(p, {.method = method}).value();
                CHECK(result.triangles.size() == 7);
                CHECK(result.weight > 5.0 * scale);
                CHECK(result.weight < 50.0 * scale);
            }
        }
        // Beyond 2^1023, where a power of two above it is no double.
        const auto largest =
            triangulate::triangulate(polygon({{{0, 0}, {1e308, 0}, {1e308, 1e308}, {0, 1e308}}})).value();
        CHECK(largest.triangles.size() == 2);
        CHECK(largest.weight == doctest::Approx(std::sqrt(2.0) * 1e308));
        CHECK(code(polygon({{{0, 0}, {1e155, 0}, {1e155, 1e-155}}})) == ErrorCode::out_of_range);
    }

    TEST_CASE("points at one position are one vertex") {
        for (const Method method : kMethods) {
            CHECK(checked(polygon({{{0, 0}, {0, 0}, {4, 0}, {4, 4}, {4, 4}, {4, 4}, {0, 4}, {0, 0}}}), method) == "");
            // Two holes that touch at a corner, and one that touches the outer ring.
            CHECK(checked(polygon({{{0, 0}, {9, 0}, {9, 9}, {0, 9}},
                                   {{2, 2}, {4, 2}, {4, 4}, {2, 4}},
                                   {{4, 4}, {6, 4}, {6, 6}, {4, 6}},
                                   {{0, 0}, {1, 0.5}, {0.5, 1}}}),
                          method) == "");
        }
    }

    TEST_CASE("if rings touch at a point, triangles use each ring's own index") {
        const auto p = polygon({{{0, 0}, {9, 0}, {9, 9}, {0, 9}}, {{0, 0}, {2, 1}, {1, 2}}});
        for (const Method method : kMethods) {
            const auto result = triangulate::triangulate(p, {.method = method}).value();
            std::set<std::uint32_t> used;
            for (const auto& t : result.triangles) used.insert(t.begin(), t.end());
            CHECK(used.size() == 7);
        }
    }

    TEST_CASE("collinear vertices and vertices on other rings' edges are used: no T-junctions") {
        for (const Method method : kMethods) {
            CHECK(checked(polygon({{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 3}, {1.5, 3}, {0, 3}}}), method) == "");
            // A hole whose corner lies on an outer edge, one that shares part of an edge.
            CHECK(checked(polygon({{{0, 0}, {9, 0}, {9, 9}, {0, 9}}, {{3, 0}, {4, 2}, {2, 2}}}), method) == "");
            CHECK(checked(polygon({{{0, 0}, {9, 0}, {9, 9}, {0, 9}}, {{3, 0}, {5, 0}, {4, 2}}}), method) == "");
            CHECK(checked(polygon({{{0, 0}, {9, 0}, {9, 9}, {0, 9}},
                                   {{3, 3}, {6, 3}, {6, 6}, {3, 6}},
                                   {{6, 2}, {8, 2}, {8, 5}, {6, 5}}}),
                          method) == "");
        }
    }

    TEST_CASE("spikes: an inner one becomes a slit, an outer one vanishes, holes of one and two points are kept") {
        for (const Method method : kMethods) {
            const auto inner = polygon({{{0, 0}, {8, 0}, {8, 8}, {4, 8}, {4, 3}, {4, 8}, {0, 8}}});
            CHECK(checked(inner, method) == "");
            const auto slit = triangulate::triangulate(inner, {.method = method}).value();
            CHECK(slit.triangles.size() == 5);
            const auto outer =
                triangulate::triangulate(polygon({{{0, 0}, {8, 0}, {8, 8}, {4, 8}, {4, 13}, {4, 8}, {0, 8}}}),
                                         {.method = method})
                    .value();
            CHECK(outer.triangles.size() == 3);
            CHECK(checked(polygon({{{0, 0}, {8, 0}, {8, 8}, {0, 8}}, {{3, 3}}, {{5, 5}, {5, 6}}}), method) == "");
        }
    }

    TEST_CASE("a hole of two points divides the polygon and takes nothing away, and outside it is an error") {
        const auto with = [](std::initializer_list<glm::dvec2> hole) {
            return polygon({{{0, 0}, {8, 0}, {8, 8}, {0, 8}}, hole});
        };
        for (const Method method : kMethods) {
            CHECK(checked(with({{0, 0}, {8, 8}}), method) == "");  // from corner to corner
            CHECK(checked(with({{4, 0}, {4, 8}}), method) == "");
            CHECK(checked(with({{0, 0}, {8, 0}}), method) == "");  // along a side
            CHECK(checked(with({{2, 0}, {8, 0}}), method) == "");
        }
        CHECK(code(with({{4, 8}, {4, 9}})) == ErrorCode::degenerate);
        CHECK(code(with({{9, 9}, {10, 9}})) == ErrorCode::degenerate);
        CHECK(code(polygon({{{0, 0}, {8, 0}, {8, 8}, {0, 8}}, {{2, 2}, {6, 2}, {6, 6}, {2, 6}}, {{2, 2}, {6, 6}}})) ==
              ErrorCode::degenerate);
    }

    TEST_CASE("either orientation of any ring gives counter-clockwise triangles") {
        auto p = polygon({{{0, 0}, {9, 0}, {9, 9}, {0, 9}}, {{2, 2}, {4, 2}, {4, 4}, {2, 4}}});
        for (int flips = 0; flips < 4; ++flips) {
            auto q = p;
            if (flips & 1) std::reverse(q.points.begin(), q.points.begin() + 4);
            if (flips & 2) std::reverse(q.points.begin() + 4, q.points.end());
            for (const Method method : kMethods) CHECK(checked(q, method) == "");
        }
    }

    TEST_CASE("random stars with holes, on and off a grid") {
        std::mt19937_64 random(5);
        for (int trial = 0; trial < 300; ++trial) {
            Polygon p;
            const double grid = trial % 3 == 0 ? 4.0 : 0.0;
            add_star(p, random, {0, 0}, 6.0, 10.0, 8 + trial % 40, grid);
            add_star(p, random, {-2, 0}, 0.5, 1.5, 3 + trial % 7, grid);
            add_star(p, random, {2, 0.1}, 0.5, 1.5, 3 + trial % 5, grid);
            for (const Method method : kMethods) CHECK(checked(p, method, grid > 0.0) == "");
        }
    }

    TEST_CASE("the same input gives the same triangles, also with reused memory") {
        std::mt19937_64 random(6);
        triangulate::Triangulator triangulator;
        triangulate::Triangulation reused;
        for (int trial = 0; trial < 50; ++trial) {
            Polygon p;
            add_star(p, random, {0, 0}, 2.0, 10.0, 4 + static_cast<int>(random() % 60), 0.0);
            for (const Method method : kMethods) {
                REQUIRE(triangulator.triangulate(p, {.method = method}, reused).has_value());
                const auto fresh = triangulate::triangulate(p, {.method = method}).value();
                CHECK(fresh.triangles == reused.triangles);
                CHECK(fresh.weight == reused.weight);
            }
        }
    }

    TEST_CASE("a polygon that is refused leaves nothing behind for the next one") {
        triangulate::Triangulator triangulator;
        triangulate::Triangulation result;
        std::mt19937_64 random(8);
        for (int trial = 0; trial < 40; ++trial) {
            Polygon bad, good;
            add_star(bad, random, {0, 0}, 5.0, 10.0, 40, 0.0);
            add_star(bad, random, {trial % 4 * 5.0, 0}, 2.0, 4.0, 20, 0.0);
            add_star(bad, random, {trial % 3 * 5.0, 0.5}, 1.0, 3.0, 20, 0.0);
            (void)triangulator.triangulate(bad, {}, result);
            add_star(good, random, {0, 0}, 5.0, 10.0, 30, 0.0);
            REQUIRE(triangulator.triangulate(good, {}, result).has_value());
            CHECK(oracle::check_triangulation(good, result.triangles) == "");
        }
    }

    TEST_CASE("each of earcut's fixtures is solved exactly, or refused by name") {
        const std::string folder = std::string(CROFTON_SHARED_DATA) + "/polygons/earcut-fixtures";
        if (!std::filesystem::exists(folder)) return;
        // Rings that cross, a hole outside, nothing inside: earcut's own list gives them 0 triangles, or an error in
        // the area, or leaves parts out.
        const std::set<std::string> invalid = {"bad-hole",   "degenerate", "empty-square",         "issue107",
                                               "issue142",   "issue83",    "simplified-us-border", "water",
                                               "water-huge", "water-huge2"};
        std::set<std::string> refused;
        std::size_t count = 0;
        for (const auto& entry : std::filesystem::directory_iterator(folder)) {
            const std::string name = entry.path().stem().string();
            INFO(name);
            const Polygon p = read_json_rings(entry.path().string());
            REQUIRE(p.points.size() >= 3);
            ++count;
            for (const Method method : kMethods) {
                const auto result = triangulate::triangulate(p, {.method = method});
                if (!result) {
                    CHECK(error_of(result).code == ErrorCode::degenerate);
                    CHECK(error_of(result).message.find("ring ") == 0);
                    refused.insert(name);
                    continue;
                }
                CHECK(oracle::check_triangulation(p, result->triangles, true) == "");
                CHECK(result->optimal == (method == Method::minimum_weight));
            }
        }
        CHECK(count == 59);
        CHECK(refused == invalid);
    }

    TEST_CASE("real polygons: level sectors, glyphs, counties") {
        const std::string folder = std::string(CROFTON_SHARED_DATA) + "/polygons/";
        if (!std::filesystem::exists(folder)) return;
        for (const char* file : {"doom.poly", "glyphs.poly", "counties10.poly", "fixtures.poly"}) {
            std::size_t index = 0, errors = 0;
            for (const auto& [name, p] : read_poly_file(folder + file)) {
                if (index++ % 29 != 0 && file[0] != 'f') continue;
                // Spikes: one county, and several of the fixtures.
                const bool weakly_simple = file[0] == 'f' || name == "Hardin";
                for (const Method method : kMethods) {
                    const auto result = triangulate::triangulate(p, {.method = method});
                    if (!result) {
                        CHECK(error_of(result).code == ErrorCode::degenerate);
                        ++errors;
                        continue;
                    }
                    CHECK(result->optimal == (method == Method::minimum_weight));
                    CHECK((result->optimal ? result->gap == 0.0 : result->gap > 0.0));
                    const std::string wrong = oracle::check_triangulation(p, result->triangles, weakly_simple);
                    if (!wrong.empty()) MESSAGE(name << ": " << wrong);
                    CHECK(wrong == "");
                }
            }
            // Ten fixtures are invalid: five cross themselves, five have no area or overlapping rings.
            CHECK(errors == (file[0] == 'f' ? 30 : 0));
        }
    }
}
