// SPDX-License-Identifier: MIT
// The minimum weight beside slits: edges that a ring traverses there and back, and holes of two points.
#include <doctest/doctest.h>
#include <crofton/triangulate/triangulate.hpp>
#include <error_of.hpp>
#include <oracle/triangulation_check.hpp>

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

    TEST_CASE("where a ring runs along itself the minimum is not heavier than Delaunay") {
        const auto p = polygon({{{18, 0}, {31, 0}, {27, 0}, {10, 0}, {30, 2}, {20, 1}, {29, 2}, {34, 2}, {28, 0}}});
        const auto least = triangulate::triangulate(p);
        const auto delaunay = triangulate::triangulate(p, {.method = triangulate::Method::delaunay});
        REQUIRE(least.has_value());
        REQUIRE(delaunay.has_value());
        CHECK(least->optimal);
        CHECK(least->weight <= delaunay->weight * (1.0 + 1e-12));
    }
}
