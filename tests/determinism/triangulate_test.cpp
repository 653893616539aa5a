// SPDX-License-Identifier: MIT
// Triangulations in the same bits everywhere.
#include <crofton/triangulate/triangulate.hpp>
#include <oracle/triangulation_check.hpp>

#include "crowd.hpp"
#include "digest.hpp"
#include "everywhere.hpp"

using namespace crofton;
using namespace crofton::test;

namespace {

constexpr triangulate::Method kMethods[] = {triangulate::Method::ear, triangulate::Method::delaunay,
                                            triangulate::Method::minimum_weight};

// Stars with and without holes, and a grid of squares whose triangulations are many of one weight.
std::vector<Polygon> polygons() {
    std::vector<Polygon> result;
    Random random(51);
    for (const int corners : {3, 7, 40, 150}) {
        add_star(result.emplace_back(), random, {0.0, 0.0}, 2.0, 5.0, corners);
        Polygon& holed = result.emplace_back();
        add_star(holed, random, {0.0, 0.0}, 9.0, 12.0, corners + 5);
        for (int k = 0; k < 3; ++k)
            add_star(holed, random, 3.5 * sampling::circle_point(k / 3.0 + 0.1), 0.5, 2.0, corners / 3 + 3);
    }
    Polygon& comb = result.emplace_back();
    for (int i = 0; i <= 10; ++i) comb.points.push_back({i, 0.0});
    for (int i = 10; i >= 0; --i) comb.points.push_back({i, i % 2 ? 1.0 : 2.0});
    comb.ring_ends.push_back(static_cast<std::uint32_t>(comb.points.size()));
    return result;
}

std::uint64_t triangulations() {
    Digest digest;
    for (const Polygon& polygon : polygons())
        for (const auto method : kMethods) {
            const auto result = *triangulate::triangulate(polygon, {.method = method});
            digest.add(result.triangles).add(result.weight).add(result.gap);
        }
    return digest.value();
}

}  // namespace

TEST_SUITE("determinism/triangulate") {
    TEST_CASE("triangles and weights are the same bits everywhere") {
        check_everywhere(0xeb9f754b59f2359a, [](Executor&) { return triangulations(); });
    }

    TEST_CASE("the published triangulations are conforming, and the lightest is proved") {
        for (const Polygon& polygon : polygons()) {
            double weight[3] = {};
            for (int m = 0; m < 3; ++m) {
                const auto result = *triangulate::triangulate(polygon, {.method = kMethods[m]});
                CHECK(oracle::check_triangulation(polygon, result.triangles) == "");
                weight[m] = result.weight;
                if (m == 2) CHECK(result.optimal);
            }
            CHECK(weight[2] <= std::min(weight[0], weight[1]) * (1.0 + 1e-14));
        }
    }
}
