// SPDX-License-Identifier: MIT
// Slits: edges that a ring traverses there and back, and holes of two points. Points at one position.
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/triangulate/triangulate.hpp>
#include <error_of.hpp>
#include <oracle/triangulation_check.hpp>
#include <vector>

#include "polygons.hpp"

using namespace crofton;
using namespace crofton::test;

TEST_SUITE("triangulate/slits") {
    TEST_CASE(
        "vertices behind a slit from here kill nothing: the only triangulations beside it need what they would kill") {
        for (const Polygon& p : {polygon({{{3, 1}, {4, 0}, {4, 1}, {5, 1}, {3, 2}, {0, 2}}, {{5, 1}, {2, 2}, {5, 1}}}),
                                 polygon({{{3, 1}, {4, 0}, {4, 1}, {5, 1}, {3, 2}, {0, 2}}, {{5, 1}, {2, 2}}})}) {
            const auto result = triangulate::triangulate(p);
            REQUIRE_MESSAGE(result.has_value(), error_of(result).message);
            CHECK(result->optimal);
            CHECK(result->triangles.size() == 5);
            CHECK(oracle::check_triangulation(p, result->triangles, true) == "");
        }
    }

    TEST_CASE("if a ring runs along itself, the minimum is not heavier than Delaunay") {
        const auto p = polygon({{{18, 0}, {31, 0}, {27, 0}, {10, 0}, {30, 2}, {20, 1}, {29, 2}, {34, 2}, {28, 0}}});
        const auto least = triangulate::triangulate(p);
        const auto delaunay = triangulate::triangulate(p, {.method = triangulate::Method::delaunay});
        REQUIRE(least.has_value());
        REQUIRE(delaunay.has_value());
        CHECK(least->optimal);
        CHECK(least->weight <= delaunay->weight * (1.0 + 1e-12));
    }

    TEST_CASE("on either side of a slit triangles name its own point") {
        const std::vector<glm::dvec2> ring = {{0, 0}, {8, 0}, {8, 8}, {4, 8}, {4, 3}, {4, 8}, {0, 8}};
        for (const auto method :
             {triangulate::Method::ear, triangulate::Method::delaunay, triangulate::Method::minimum_weight})
            for (const bool backward : {false, true}) {
                Polygon p;
                p.points.assign(ring.begin(), ring.end());
                if (backward) std::reverse(p.points.begin(), p.points.end());
                p.ring_ends = {7};
                const auto result = triangulate::triangulate(p, {.method = method}).value();
                for (const auto& t : result.triangles) {
                    double middle = 0.0;
                    for (const std::uint32_t i : t) middle += p.points[i].x / 3.0;
                    // The point at (4, 8) next to (8, 8) is number 3 either way; the other point there is 5 or 1.
                    const std::uint32_t wrong = middle < 4.0 ? 3 : backward ? 1 : 5;
                    if (middle != 4.0) CHECK(std::count(t.begin(), t.end(), wrong) == 0);
                }
            }
    }

    TEST_CASE("triangles use the first of consecutive points at one position") {
        const auto p = polygon({{{0, 0}, {0, 0}, {4, 0}, {4, 4}, {4, 4}, {4, 4}, {0, 4}, {0, 0}}});
        for (const auto method :
             {triangulate::Method::ear, triangulate::Method::delaunay, triangulate::Method::minimum_weight}) {
            const auto result = triangulate::triangulate(p, {.method = method}).value();
            for (const auto& t : result.triangles)
                for (const std::uint32_t i : t) CHECK((i == 0 || i == 2 || i == 3 || i == 6));
        }
    }
}
