// SPDX-License-Identifier: MIT
// A part of what is done without the minimum: a triangulation is taken as it is and made lighter.
#include <doctest/doctest.h>
#include <crofton/triangulate/triangulate.hpp>
#include <minimum_weight/local_improvement.hpp>
#include <oracle/triangulation_check.hpp>
#include <random>

#include "polygons.hpp"

using namespace crofton;
using namespace crofton::test;
using namespace crofton::triangulate;

TEST_SUITE("triangulate/local_improvement") {
    TEST_CASE(
        "any triangulation of a domain is taken, none is made heavier, and one that covers something twice is "
        "refused") {
        std::mt19937_64 random(61);
        int lighter = 0, taken = 0;
        for (int trial = 0; trial < 60; ++trial) {
            CAPTURE(trial);
            Polygon p;
            add_star(p, random, {0, 0}, 4.0, 10.0, 4 + 2 * trial, 0.0);
            if (trial % 2) add_star(p, random, {0.3, -0.2}, 1.0, 2.0, 3 + trial % 9, 0.0);
            Domain domain;
            REQUIRE(domain.build(p).has_value());
            LocalImprovement improvement;
            for (const Method method : {Method::ear, Method::delaunay}) {
                const auto start = triangulate::triangulate(p, {.method = method}).value();
                REQUIRE(improvement.start_from_triangles(domain, start.triangles));
                ++taken;
                CHECK(improvement.weight() * domain.scale() == doctest::Approx(start.weight).epsilon(1e-12));
                const TriangulateOptions unlimited;
                Watch watch(unlimited);
                improvement.run(watch);
                CHECK(improvement.weight() * domain.scale() <= start.weight * (1.0 + 1e-12));
                lighter += improvement.weight() * domain.scale() < 0.999 * start.weight;
                Vector<std::array<std::uint32_t, 3>> triangles;
                improvement.write(triangles);
                CHECK(oracle::check_triangulation(p, triangles) == "");
                // One that covers something twice is none.
                triangles.push_back(triangles.front());
                CHECK_FALSE(improvement.start_from_triangles(domain, triangles));
            }
        }
        CHECK(lighter > taken / 2);
    }
}
