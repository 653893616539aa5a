// SPDX-License-Identifier: MIT
#include <crofton/triangulate/triangulate.hpp>

#include "handles.hpp"

using namespace crofton::capi_test;

TEST_SUITE("capi/triangulate") {
    TEST_CASE("rings that leave the points, wrong sizes and unknown methods are refused") {
        const Triangulator triangulator = make_triangulator();
        const double points[] = {0, 0, 2, 0, 2, 1, 0, 1};
        uint32_t ends[] = {3, 5};
        crofton_polygon polygon{sizeof polygon, points, 4, ends, 2};
        auto result = sized<crofton_triangulation>();
        const auto run = [&] {
            return crofton_triangulate(triangulator.get(), &polygon, CROFTON_TRIANGULATE_MINIMUM_WEIGHT, &result);
        };
        CHECK(run() == CROFTON_OUT_OF_RANGE);
        CHECK(crofton_last_error_item() == 1);
        ends[0] = 4;
        ends[1] = 3;
        CHECK(run() == CROFTON_OUT_OF_RANGE);
        polygon.ring_count = 1;
        ends[0] = 3;
        CHECK(run() == CROFTON_OUT_OF_RANGE);
        polygon.size = 3;
        CHECK(run() == CROFTON_WRONG_SIZE);
        polygon = {sizeof polygon, points, 4, ends, 1};
        ends[0] = 4;
        result.size = 0;
        CHECK(run() == CROFTON_WRONG_SIZE);
        result.size = sizeof result;
        CHECK(crofton_triangulate(triangulator.get(), &polygon, 5, &result) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_triangulate(nullptr, &polygon, CROFTON_TRIANGULATE_EAR, &result) == CROFTON_BAD_HANDLE);
        const double line[] = {0, 0, 1, 0, 2, 0};
        uint32_t end = 3;
        polygon = {sizeof polygon, line, 3, &end, 1};
        CHECK(run() != CROFTON_OK);
    }

    TEST_CASE("a kite is cut along its short diagonal") {
        const Triangulator triangulator = make_triangulator();
        const double points[] = {0, 0, 1, -0.25, 5, 0, 1, 0.25};  // diagonals of length 5 and 0.5
        const uint32_t end = 4;
        const crofton_polygon polygon{sizeof polygon, points, 4, &end, 1};
        auto result = sized<crofton_triangulation>();
        REQUIRE(crofton_triangulate(triangulator.get(), &polygon, CROFTON_TRIANGULATE_MINIMUM_WEIGHT, &result) ==
                CROFTON_OK);
        CHECK(result.triangle_count == 2);
        CHECK(result.weight == doctest::Approx(0.5));
        const crofton::Polygon same{{{0, 0}, {1, -0.25}, {5, 0}, {1, 0.25}}, {4}};
        const auto expected = crofton::triangulate::triangulate(same);
        REQUIRE(expected);
        CHECK(result.optimal == (expected->optimal ? 1 : 0));
        CHECK(result.gap == expected->gap);
        for (std::size_t i = 0; i < 6; ++i) CHECK(result.indices[i] < 4);
    }
}
