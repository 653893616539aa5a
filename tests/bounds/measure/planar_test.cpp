// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/geometry/predicates.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <error_of.hpp>
#include <numbers>
#include <random>
#include <vector>

using namespace crofton;
using namespace crofton::measure;
using namespace crofton::sampling;
using std::numbers::pi;

TEST_SUITE("measure/planar") {
    TEST_CASE("a hull of nothing, or of a NaN, is an error that names the culprit") {
        CHECK(error_of(measure::convex_hull({})).code == ErrorCode::empty);
        for (std::size_t bad = 0; bad < 5; ++bad)
            for (const double value : {std::nan(""), HUGE_VAL, -HUGE_VAL})
                for (const int axis : {0, 1}) {
                    std::vector<glm::dvec2> points = {{0.0, 0.0}, {2.0, 0.0}, {3.0, 3.0}, {0.0, 3.0}, {1.0, 1.0}};
                    points[bad][axis] = value;
                    const auto hull = convex_hull(points);
                    REQUIRE(!hull.has_value());
                    CHECK(error_of(hull).code == ErrorCode::non_finite);
                    CHECK(error_of(hull).item == bad);
                }
    }

    TEST_CASE("equal points have one corner, collinear points two") {
        const std::vector<glm::dvec2> equal(5, {2.0, 3.0});
        CHECK(convex_hull(equal)->size() == 1);
        std::vector<glm::dvec2> line;
        for (int i = 0; i < 9; ++i) line.emplace_back((i * 4) % 9, 2 * ((i * 4) % 9));
        const auto hull = convex_hull(line);
        REQUIRE(hull->size() == 2);
        CHECK(planar_measures_of_convex_polygon(*hull).perimeter == doctest::Approx(2.0 * 8.0 * std::sqrt(5.0)));
        CHECK(planar_measures_of_convex_polygon(*hull).area == 0.0);
    }

    TEST_CASE("the hull of a filled square is its four corners, counter-clockwise") {
        std::vector<glm::dvec2> grid;
        for (int y = 4; y >= 0; --y)
            for (int x = 0; x < 5; ++x) grid.emplace_back(x, y);
        const auto hull = convex_hull(grid).value();
        CHECK(std::vector<glm::dvec2>(hull.begin(), hull.end()) ==
              std::vector<glm::dvec2>{{0.0, 0.0}, {4.0, 0.0}, {4.0, 4.0}, {0.0, 4.0}});
    }

    TEST_CASE("memory behind a polygon's last corner is not read") {
        const std::vector<glm::dvec2> points = {{0.0, 0.0}, {2.0, 0.0}, {2.0, 3.0}, {0.0, 3.0}, {std::nan(""), 1e9}};
        CHECK(convex_hull(std::span(points).first(4)).value().size() == 4);
        const PlanarMeasures polygon = planar_measures_of_convex_polygon(std::span(points).first(4));
        CHECK(polygon.area == 6.0);
        CHECK(polygon.perimeter == 10.0);
    }

    TEST_CASE("a polygon of many corners has the measures of its circle") {
        std::vector<glm::dvec2> points;
        for (int i = 0; i < 4096; ++i) points.push_back(3.0 * circle_point(i / 4096.0) + glm::dvec2(10.0, -7.0));
        const PlanarMeasures polygon = planar_measures_of_convex_polygon(points), disc = planar_measures_of_disc(3.0);
        CHECK(polygon.area == doctest::Approx(disc.area).epsilon(1e-5));
        CHECK(polygon.perimeter == doctest::Approx(disc.perimeter).epsilon(1e-6));
    }

    TEST_CASE("the kinematic formula gives Steiner's formula for a disc and the Minkowski sum of two segments") {
        const PlanarMeasures rectangle = planar_measures_of_rectangle(2.0, 3.0);
        const double steiner = 6.0 + 10.0 * 0.5 + pi * 0.25;
        CHECK(kinematic_measure(planar_measures_of_disc(0.5), rectangle) == doctest::Approx(steiner));
        CHECK(kinematic_measure(rectangle, planar_measures_of_disc(0.5)) == doctest::Approx(steiner));
        // Segments a and b at angle φ: |ab sin φ|, whose mean is 2ab/π.
        CHECK(kinematic_measure(planar_measures_of_segment(2.0), planar_measures_of_segment(5.0)) ==
              doctest::Approx(2.0 * 10.0 / pi));
    }

    TEST_CASE("the kinematic formula is additive where the union is convex") {
        // Two rectangles side by side share a segment: f(A ∪ B) + f(A ∩ B) = f(A) + f(B).
        const PlanarMeasures b = planar_measures_of_disc(0.7);
        const double whole = kinematic_measure(b, planar_measures_of_rectangle(5.0, 2.0)),
                     common = kinematic_measure(b, planar_measures_of_segment(2.0));
        CHECK(whole + common == doctest::Approx(kinematic_measure(b, planar_measures_of_rectangle(3.0, 2.0)) +
                                                kinematic_measure(b, planar_measures_of_rectangle(2.0, 2.0))));
    }

    TEST_CASE(
        "a hull's corners turn left and hold every point, exactly, also where points are collinear but for rounding") {
        std::mt19937_64 random(17);
        std::uniform_real_distribution<double> uniform(-1.0, 1.0);
        for (int trial = 0; trial < 2000; ++trial) {
            const glm::dvec2 along(uniform(random), uniform(random));
            std::vector<glm::dvec2> points;
            for (int i = 0; i < 3 + trial % 8; ++i) points.push_back(0.3 + along * uniform(random));
            const auto hull = convex_hull(points).value();
            const std::size_t n = hull.size();
            for (std::size_t i = 0; i < n && n > 2; ++i) {
                const glm::dvec2 &a = hull[i], &b = hull[(i + 1) % n];
                CHECK(orientation(a, b, hull[(i + 2) % n]) > 0);
                for (const glm::dvec2& p : points) CHECK(orientation(a, b, p) >= 0);
            }
        }
    }
}
