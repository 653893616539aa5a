// SPDX-License-Identifier: MIT
// The proof by itself: begun without a good box, it must find out by itself which orientations may have fewer hits.
#include <doctest/doctest.h>
#include <algorithm>
#include <count_search.hpp>
#include <crofton/fit/fit.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/sampling/sampling.hpp>

using namespace crofton;
using namespace crofton::study;

TEST_SUITE("study/count search") {
    TEST_CASE("the bound is below the hits of every orientation, and near the least it has seen") {
        sampling::Random random(23);
        for (int trial = 0; trial < 4; ++trial) {
            // Long and thin, and turned, so that the orientation it begins with has far too many.
            const glm::dmat3 turn = sampling::rotation(random.point<3>());
            std::vector<glm::dvec3> points;
            for (int i = 0; i < 20; ++i)
                points.push_back(turn * (glm::dvec3(2.0, 0.3, 0.1) * sampling::ball_point(random.point<3>())));
            const auto queries = QuerySample::lines({glm::dvec3(0.0), 3.0}, 400, 5);
            const auto hull = convex_hull(points);
            REQUIRE(queries.has_value());
            REQUIRE(hull.has_value());
            const Vector<std::uint32_t> all = queries->all();
            const auto hits = [&](const glm::dmat3& axes) {
                return static_cast<std::uint32_t>(
                    queries->hitting(all, fit::fit_oriented(points, glm::mat3(axes)).value()).size());
            };
            std::uint32_t found = queries->size();
            const CountProof proof =
                prove_count(points, hull->triangles, *queries, all, found, 0.1, 20000,
                            [&](const glm::dmat3& axes) { return found = std::min(found, hits(axes)); });
            std::uint32_t least = hits(turn);
            for (int i = 0; i < 2000; ++i) least = std::min(least, hits(sampling::rotation(random.point<3>())));
            CHECK(proof.lower_bound <= least);
            CHECK(proof.lower_bound <= found);
            CHECK(proof.lower_bound > 0);
            CHECK(found <= hits(turn) * 3 / 2);
        }
    }
}
