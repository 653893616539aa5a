// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <assets/convex_pieces.hpp>
#include <cmath>
#include <crofton/geometry/predicates.hpp>
#include <crofton/triangulate/triangulate.hpp>
#include <random>

using namespace crofton;
using assets::convex_pieces;

namespace {

Polygon ring_of(std::vector<glm::dvec2> points) {
    Polygon polygon;
    polygon.points.assign(points.begin(), points.end());
    polygon.ring_ends = {static_cast<std::uint32_t>(points.size())};
    return polygon;
}

double twice_area(const Polygon& polygon, std::span<const std::uint32_t> corners) {
    double sum = 0.0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec2 &a = polygon.points[corners[i]], &b = polygon.points[corners[(i + 1) % corners.size()]];
        sum += a.x * b.y - a.y * b.x;
    }
    return sum;
}

}  // namespace

TEST_SUITE("assets/convex_pieces") {
    TEST_CASE("two triangles are one piece where they are strictly convex together") {
        using Triangles = std::vector<std::array<std::uint32_t, 3>>;
        const Triangles halves = {{0, 1, 2}, {0, 2, 3}};
        const auto square = convex_pieces(ring_of({{0, 0}, {2, 0}, {2, 2}, {0, 2}}), halves);
        REQUIRE(square.size() == 1);
        auto corners = square[0];
        std::sort(corners.begin(), corners.end());
        CHECK(corners == std::array<std::uint32_t, 4>{0, 1, 2, 3});
        // An arrow, and a triangle with a corner within a side.
        CHECK(convex_pieces(ring_of({{0, 0}, {2, 0}, {0.5, 0.5}, {0, 2}}), halves).size() == 2);
        CHECK(convex_pieces(ring_of({{0, 0}, {2, 0}, {1, 1}, {0, 2}}), halves).size() == 2);
        CHECK(convex_pieces(ring_of({{0, 0}, {2, 0}, {1.0000001, 1}, {0, 2}}), halves).size() == 1);
        CHECK(convex_pieces({}, {}).empty());
    }

    TEST_CASE("the longest common side goes first") {
        // Three triangles in a row: the second can join either neighbour.
        const Polygon row = ring_of({{0, 0}, {4, 0}, {4.5, 1}, {0.5, 1}, {3, 3}});
        const auto pieces =
            convex_pieces(row, std::vector<std::array<std::uint32_t, 3>>{{0, 1, 3}, {1, 2, 3}, {3, 2, 4}});
        REQUIRE(pieces.size() == 2);
        // 3–2 is 4 long, 1–3 is 3.6.
        CHECK(pieces[1] == std::array<std::uint32_t, 4>{0, 1, 3, 3});
    }

    TEST_CASE("pieces of random polygons are convex, and hold each triangle once") {
        std::mt19937 random(11);
        std::uniform_real_distribution<double> radius(0.2, 1.0);
        std::size_t quadrangles = 0;
        for (int trial = 0; trial < 200; ++trial) {
            std::vector<glm::dvec2> star;
            const int count = 4 + trial % 40;
            for (int i = 0; i < count; ++i) {
                const double angle = 6.283185307179586 * i / count, r = radius(random);
                star.emplace_back(r * std::cos(angle), r * std::sin(angle));
            }
            const Polygon polygon = ring_of(star);
            const auto triangulation = triangulate::triangulate(polygon).value();
            double covered = 0.0;
            std::size_t triangles = 0;
            for (const auto& piece : convex_pieces(polygon, triangulation.triangles)) {
                const std::size_t corners = piece[3] == piece[2] ? 3 : 4;
                for (std::size_t i = 0; i < corners; ++i)
                    CHECK(orientation(polygon.points[piece[i]], polygon.points[piece[(i + 1) % corners]],
                                      polygon.points[piece[(i + 2) % corners]]) > 0);
                covered += twice_area(polygon, std::span(piece).first(corners));
                triangles += corners - 2;
                quadrangles += corners == 4;
            }
            CHECK(triangles == triangulation.triangles.size());
            double whole = 0.0;
            for (const auto& triangle : triangulation.triangles) whole += twice_area(polygon, triangle);
            CHECK(covered == doctest::Approx(whole));
        }
        CHECK(quadrangles > 100);
    }
}
