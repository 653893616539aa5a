// SPDX-License-Identifier: MIT
// The least length of a vertex's diagonals, behind more edges than are looked through.
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/geometry/mesh.hpp>
#include <random>

#include "minimum_weight/length_bounds.hpp"

using namespace crofton;
using namespace crofton::triangulate;

namespace {

// v, a column of 100 points to the right, w above v, and p to the left of vw. p is so near to vw that all edges of the
// Delaunay triangulation go from p to the column. They lie between v and w, which see each other.
Polygon behind_a_fan(double depth, double height, double above, double beside, double far, double step) {
    Polygon p;
    p.points.emplace_back(0.0, -depth);
    for (int i = 0; i < 100; ++i) p.points.emplace_back(far, height + step * (i - 100));
    p.points.emplace_back(0.0, above);
    p.points.emplace_back(-beside, height);
    p.ring_ends = {103};
    return p;
}

double least_from_first(const Polygon& polygon) {
    Domain domain;
    REQUIRE(domain.build(polygon).has_value());
    DelaunayBound bound;
    CHECK(bound.weight(domain) > 0.0);
    return bound.shortest()[domain.vertex_of(0)] * domain.scale();
}

}  // namespace

TEST_SUITE("triangulate/length bounds") {
    TEST_CASE("a diagonal behind 100 edges is no shorter than the bound, which is not far below it") {
        const double bound = least_from_first(behind_a_fan(0.0, 0.9, 1.0, 0.005, 1.0, 1e-5));
        CHECK(bound <= 1.0);
        CHECK(bound > 0.89);
    }

    TEST_CASE("nor is one that ends a rounding behind them") {
        std::mt19937_64 random(61);
        const auto random_number = [&](double low, double high) {
            return std::uniform_real_distribution<double>(low, high)(random);
        };
        for (int trial = 0; trial < 2000; ++trial) {
            const double depth = random_number(8.0, 9.0), height = random_number(0.5, 0.6);
            const double above = std::nextafter(height, 2.0);
            const double bound =
                least_from_first(behind_a_fan(depth, height, above, 1e-33, random_number(0.3, 3.3), 0x1p-52));
            // In the real numbers: both summands are multiples of 2^-53.
            const double whole = std::floor(bound), rest = bound - whole;
            REQUIRE((whole - std::floor(depth)) + (rest - (depth - std::floor(depth))) <= above);
            REQUIRE(bound > 0.99 * (depth + height));
        }
    }
}
