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
