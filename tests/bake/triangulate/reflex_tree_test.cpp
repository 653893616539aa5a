// SPDX-License-Identifier: MIT
// The tree of reflex corners against the exact predicate.
#include <doctest/doctest.h>
#include <crofton/geometry/predicates.hpp>
#include <random>
#include <vector>

#include "ear/reflex_tree.hpp"

using namespace crofton;
using namespace crofton::triangulate;

TEST_SUITE("triangulate/reflex tree") {
    TEST_CASE("a corner that rounding puts onto a side of the ear is found wherever it is not outside") {
        std::mt19937_64 random(5);
        std::uniform_real_distribution<double> unit(0.0, 1.0);
        std::vector<Index> vertices(100);
        for (Index i = 0; i < vertices.size(); ++i) vertices[i] = i;
        ReflexTree tree;
        int inside = 0;
        for (int trial = 0; trial < 20000; ++trial) {
            const glm::dvec2 a(unit(random), unit(random)), b(3.0 * unit(random), 3.0 * unit(random));
            const glm::dvec2 way = b - a, c = a + 0.5 * way + glm::dvec2(-way.y, way.x);
            const glm::dvec2 p = a + (0.1 + 0.8 * unit(random)) * way;
            // All corners are at p: so is the box of every node.
            const std::vector<glm::dvec2> points(vertices.size(), p);
            tree.build(points, vertices);
            if (orientation(a, b, p) < 0) continue;
            ++inside;
            REQUIRE(tree.find({a, b, c}, [](Index, const glm::dvec2&) { return true; }) != kNone);
        }
        CHECK(inside > 5000);
    }
}
