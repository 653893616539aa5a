// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/geometry/mesh.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <random>
#include <set>
#include <span>
#include <vector>

using namespace crofton;

namespace {

std::span<const glm::dvec3> view(const std::vector<glm::dvec3>& points) {
    return points;
}

// Every point lies on the inner side of every face, and the faces close up: each directed edge has its opposite once.
void check_solid(const std::vector<glm::dvec3>& points, const ConvexHull& hull, double tolerance) {
    REQUIRE(hull.rank == 3);
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    std::set<std::uint32_t> corners;
    for (std::size_t t = 0; t < hull.triangles.size(); t += 3) {
        const std::uint32_t i = hull.triangles[t], j = hull.triangles[t + 1], k = hull.triangles[t + 2];
        const glm::dvec3 normal = glm::cross(points[j] - points[i], points[k] - points[i]);
        for (const glm::dvec3& p : points)
            CHECK(glm::dot(p - points[i], normal) <= tolerance * std::max(glm::length(normal), 1e-3));
        for (const auto& edge : {std::pair(i, j), std::pair(j, k), std::pair(k, i)}) CHECK(edges.insert(edge).second);
        corners.insert({i, j, k});
    }
    for (const auto& [a, b] : edges) CHECK(edges.count({b, a}) == 1);
    CHECK(std::vector<std::uint32_t>(corners.begin(), corners.end()) ==
          std::vector<std::uint32_t>(hull.vertices.begin(), hull.vertices.end()));
    CHECK(hull.triangles.size() / 3 == 2 * hull.vertices.size() - 4);  // Euler
}

}  // namespace

TEST_SUITE("geometry/convex_hull") {
    TEST_CASE("no points and bad points are refused by their first index") {
        CHECK(error_of(convex_hull(std::span<const glm::dvec3>())).code == ErrorCode::empty);
        std::vector<glm::dvec3> points(5, glm::dvec3(1.0));
        points[3].y = std::numeric_limits<double>::quiet_NaN();
        points[4].x = std::numeric_limits<double>::infinity();
        CHECK(error_of(convex_hull(view(points))).item == 3);
        CHECK(error_of(convex_hull(view(points))).code == ErrorCode::non_finite);
        points[2].z = 1e31;
        CHECK(error_of(convex_hull(view(points))).code == ErrorCode::out_of_range);
    }

    TEST_CASE("equal points have rank 0, points on a line rank 1, in a plane rank 2") {
        const std::vector<glm::dvec3> same(7, glm::dvec3(3.0, -1.0, 1e8));
        ConvexHull hull = convex_hull(view(same)).value();
        CHECK(hull.rank == 0);
        CHECK(hull.vertices.size() == 1);
        std::vector<glm::dvec3> line;
        for (int i : {3, 1, 4, 1, 5, 0, 2}) line.push_back(glm::dvec3(1.0, 2.0, -0.5) * double(i) + glm::dvec3(7.0));
        hull = convex_hull(view(line)).value();
        CHECK(hull.rank == 1);
        CHECK(hull.vertices == Vector<std::uint32_t>{4, 5});
        std::vector<glm::dvec3> plane;
        for (int x = 0; x <= 4; ++x)
            for (int y = 0; y <= 3; ++y)
                plane.push_back(glm::dvec3(1.0, 2.0, 0.0) * double(x) + glm::dvec3(0.0, 1.0, 3.0) * double(y));
        hull = convex_hull(view(plane)).value();
        CHECK(hull.rank == 2);
        CHECK(std::set<std::uint32_t>(hull.vertices.begin(), hull.vertices.end()) ==
              std::set<std::uint32_t>{0, 3, 16, 19});
        CHECK(hull.triangles.empty());
    }

    TEST_CASE("points of a plane, on lines along its longest diagonal, have one hull in whatever order they come") {
        std::vector<glm::dvec3> points;
        for (int x = -2; x <= 2; ++x) points.emplace_back(x, 0.0, 0.0);
        for (int x = -1; x <= 1; ++x)
            for (const double y : {-1.0, 1.0}) points.emplace_back(x, y, 0.0);
        std::mt19937 random(3);
        for (int trial = 0; trial < 200; ++trial) {
            std::shuffle(points.begin(), points.end(), random);
            const ConvexHull hull = convex_hull(view(points)).value();
            CHECK(hull.rank == 2);
            REQUIRE(hull.vertices.size() == 6);
            for (std::size_t i = 0; i < 6; ++i) {
                const glm::dvec3 &a = points[hull.vertices[i]], &b = points[hull.vertices[(i + 1) % 6]],
                                 &c = points[hull.vertices[(i + 2) % 6]];
                CHECK(std::abs(a.x) == (a.y == 0.0 ? 2.0 : 1.0));
                CHECK(std::abs(glm::cross(b - a, c - b).z) > 0.0);
                CHECK(glm::cross(b - a, c - b).z * glm::cross(a, b).z > 0.0);
            }
        }
    }

    TEST_CASE("a cube with points inside and on its faces has eight corners and twelve triangles") {
        std::vector<glm::dvec3> points;
        for (int x = 0; x <= 2; ++x)
            for (int y = 0; y <= 2; ++y)
                for (int z = 0; z <= 2; ++z) points.emplace_back(x, y, z);
        const ConvexHull hull = convex_hull(view(points)).value();
        CHECK(hull.vertices == Vector<std::uint32_t>{0, 2, 6, 8, 18, 20, 24, 26});
        check_solid(points, hull, 1e-12);
    }

    TEST_CASE("all points of a sphere are corners, none of those inside it, at any scale and place") {
        std::mt19937 random(1);
        std::normal_distribution<double> normal;
        for (const double scale : {1e-30, 1.0, 1e25})
            for (const double offset : {0.0, 1e4}) {
                std::vector<glm::dvec3> points;
                for (int i = 0; i < 200; ++i)
                    points.push_back((glm::normalize(glm::dvec3(normal(random), normal(random), normal(random))) +
                                      glm::dvec3(offset)) *
                                     scale);
                for (int i = 0; i < 3000; ++i)
                    points.push_back((0.9 * glm::normalize(glm::dvec3(normal(random), normal(random), normal(random))) +
                                      glm::dvec3(offset)) *
                                     scale);
                const ConvexHull hull = convex_hull(view(points)).value();
                CHECK(hull.vertices.size() == 200);
                CHECK(hull.vertices.back() == 199);
                if (scale == 1.0) check_solid(points, hull, 1e-9);
            }
    }

    TEST_CASE("slivers of any thinness give a hull") {
        std::mt19937 random(2);
        std::normal_distribution<double> normal;
        for (double thickness = 1e-3; thickness > 1e-18; thickness *= 0.1) {
            std::vector<glm::dvec3> points;
            for (int i = 0; i < 50; ++i)
                points.emplace_back(normal(random), normal(random), thickness * normal(random));
            const ConvexHull hull = convex_hull(view(points)).value();
            CHECK(hull.rank >= 2);
            CHECK(hull.vertices.size() >= 3);
        }
    }

    TEST_CASE("the first of equal points is the corner, in any order, in the plane and in space") {
        std::mt19937_64 random(41);
        for (const bool flat : {false, true})
            for (int trial = 0; trial < 50; ++trial) {
                std::vector<glm::dvec3> points;
                for (int i = 0; i < 24; ++i) points.emplace_back(i & 1, i >> 1 & 1, flat ? 0.5 * (i & 1) : i >> 2 & 1);
                std::shuffle(points.begin(), points.end(), random);
                const auto hull = convex_hull(std::span<const glm::dvec3>(points)).value();
                CHECK(hull.vertices.size() == (flat ? 4 : 8));
                if (!flat) check_solid(points, hull, 1e-12);
                for (const std::uint32_t v : hull.vertices)
                    CHECK(std::find(points.begin(), points.end(), points[v]) - points.begin() == v);
            }
    }

    TEST_CASE("a cube has eight corners however small, down to the smallest doubles") {
        for (const double size : {1e-200, 1e-300, 1e-308, 1e-315}) {
            std::vector<glm::dvec3> points;
            for (int i = 0; i < 8; ++i) points.push_back(size * glm::dvec3(i & 1, i >> 1 & 1, i >> 2 & 1));
            const auto hull = convex_hull(std::span<const glm::dvec3>(points)).value();
            CHECK(hull.rank == 3);
            CHECK(hull.vertices.size() == 8);
        }
    }
}
