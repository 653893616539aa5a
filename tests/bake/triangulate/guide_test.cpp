// SPDX-License-Identifier: MIT
// The code that docs/triangulate.md shows, compiled and run.
#include <doctest/doctest.h>
#include <crofton/triangulate/triangulate.hpp>
#include <cstdio>

namespace {

double area_drawn = 0.0;
void draw(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    area_drawn += 0.5 * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
}

void triangulate_a_wall() {
    crofton::Polygon wall;
    wall.points = {{0, 0}, {8, 0}, {8, 3}, {0, 3}, {1, 1}, {2, 1}, {2, 2}, {1, 2}};
    wall.ring_ends = {4, 8};  // the outer ring, then a window

    crofton::triangulate::Triangulator triangulator;  // keeps its memory from call to call
    crofton::triangulate::Triangulation result;
    if (auto done = triangulator.triangulate(wall, {}, result); !done) {
        std::printf("%s\n", done.error().message.c_str());
        return;
    }
    for (const auto& [a, b, c] : result.triangles) draw(wall.points[a], wall.points[b], wall.points[c]);
    CHECK(result.optimal);
}

}  // namespace

TEST_SUITE("triangulate/guide") {
    TEST_CASE("a wall with a window is covered once") {
        triangulate_a_wall();
        CHECK(area_drawn == doctest::Approx(8.0 * 3.0 - 1.0));
    }
}
