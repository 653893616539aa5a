// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <array>
#include <cmath>
#include <crofton/geometry/cut_at_vertices.hpp>
#include <glm/geometric.hpp>
#include <vector>

using namespace crofton;

namespace {

using CutCorners = std::array<std::uint32_t, 3>;

double area_of_cut(const std::vector<glm::vec3>& points, const CutCorners& t) {
    const glm::dvec3 a(points[t[0]]), b(points[t[1]]), c(points[t[2]]);
    return 0.5 * glm::length(glm::cross(b - a, c - a));
}

}  // namespace

TEST_SUITE("geometry/cut_at_vertices") {
    TEST_CASE("a side along any axis is cut at all vertices on it, and covers the same area in the same order") {
        for (int axis = 0; axis < 3; ++axis) {
            const auto at = [&](float along, float across) {
                glm::vec3 p(1.0f);
                p[axis] = along;
                p[(axis + 1) % 3] += across;
                return p;
            };
            // A triangle with a side of length 4, and one whose corners lie on it, beside it and behind its end.
            const std::vector<glm::vec3> points = {at(0, 0), at(4, 0),  at(2, 3), at(1, 0),
                                                   at(3, 0), at(2, -1), at(5, 0), at(6, -2)};
            const std::vector<CutCorners> triangles = {{0, 1, 2}, {3, 5, 4}, {6, 5, 7}};
            const auto cut = cut_at_vertices(points, triangles);
            CHECK(cut.size() == 5);
            double sum = 0.0;
            for (const CutCorners& t : cut) {
                sum += area_of_cut(points, t);
                CHECK(area_of_cut(points, t) > 0.0);
                for (std::size_t k = 0; k < 3; ++k) {  // nothing is left strictly within a side
                    const glm::vec3 &p = points[t[k]], &q = points[t[(k + 1) % 3]];
                    for (const glm::vec3& v : points)
                        CHECK_FALSE((glm::length(glm::cross(q - p, v - p)) == 0.0f && glm::dot(v - p, v - q) < 0.0f));
                }
            }
            double before = 0.0;
            for (const CutCorners& t : triangles) before += area_of_cut(points, t);
            CHECK(sum == before);
        }
    }

    TEST_CASE("triangles without area are dropped, and triangles without vertices on their sides stay") {
        const std::vector<glm::vec3> points = {{0, 0, 0}, {4, 0, 0}, {2, 3, 0}, {2, 0, 0.5f}};
        const std::vector<CutCorners> triangles = {{0, 1, 2}, {0, 0, 1}, {3, 1, 3}, {1, 3, 2}};
        const auto cut = cut_at_vertices(points, triangles);
        REQUIRE(cut.size() == 2);
        CHECK(cut[0] == triangles[0]);
        CHECK(cut[1] == triangles[3]);
        const std::vector<glm::vec3> line = {{0, 1, 0}, {0, 2, 0}, {0, 5, 0}};
        CHECK(cut_at_vertices(line, std::vector<CutCorners>{{0, 1, 2}}).empty());
        // Two corners in one place, with numbers of their own: nothing is between them and the third.
        for (int axis = 0; axis < 3; ++axis) {
            glm::vec3 far(1.0f);
            far[axis] = 5.0f;
            const std::vector<glm::vec3> needle = {glm::vec3(1.0f), glm::vec3(1.0f), far};
            for (const CutCorners& t : {CutCorners{0, 1, 2}, CutCorners{2, 0, 1}, CutCorners{1, 2, 0}})
                CHECK(cut_at_vertices(needle, std::vector<CutCorners>{t}).empty());
        }
        CHECK(cut_at_vertices({}, {}).empty());
    }
}
