// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/fit/fit.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

using namespace crofton;
using fit::PlanarCriterion;

namespace {

using Points = std::vector<glm::dvec2>;

std::span<const glm::dvec2> view(const Points& points) {
    return points;
}

// In extended precision: rounding of the test itself must not matter.
bool contains(const Rectangle& r, const glm::dvec2& p) {
    const long double x = static_cast<long double>(p.x) - static_cast<long double>(r.center.x);
    const long double y = static_cast<long double>(p.y) - static_cast<long double>(r.center.y);
    const long double u = static_cast<long double>(r.axis.x), v = static_cast<long double>(r.axis.y);
    return std::fabs(u * x + v * y) <= static_cast<long double>(r.half_extents.x) &&
           std::fabs(u * y - v * x) <= static_cast<long double>(r.half_extents.y);
}

bool contains(const Disc& c, const glm::dvec2& p) {
    const long double x = static_cast<long double>(p.x) - static_cast<long double>(c.center.x);
    const long double y = static_cast<long double>(p.y) - static_cast<long double>(c.center.y);
    return std::sqrt(x * x + y * y) <= static_cast<long double>(c.radius);
}

double measure_of(const Rectangle& r, PlanarCriterion criterion) {
    return criterion == PlanarCriterion::area ? area(r) : perimeter(r);
}

// The least over many directions.
double by_brute_force(const Points& points, PlanarCriterion criterion, int steps) {
    double best = 1e300;
    for (int i = 0; i < steps; ++i) {
        const double angle = 0.5 * std::numbers::pi * i / steps;
        const glm::dvec2 axes[2] = {{std::cos(angle), std::sin(angle)}, {-std::sin(angle), std::cos(angle)}};
        double size[2];
        for (int k = 0; k < 2; ++k) {
            double low = 1e300, high = -1e300;
            for (const glm::dvec2& p : points) {
                low = std::min(low, glm::dot(p, axes[k]));
                high = std::max(high, glm::dot(p, axes[k]));
            }
            size[k] = high - low;
        }
        best = std::min(best, criterion == PlanarCriterion::area ? size[0] * size[1] : 2.0 * (size[0] + size[1]));
    }
    return best;
}

}  // namespace

TEST_SUITE("fit/planar") {
    TEST_CASE("no points and bad points are refused by their first index") {
        CHECK(fit::minimal_rectangle({}, PlanarCriterion::area).error().code == ErrorCode::empty);
        CHECK(fit::minimal_disc({}).error().code == ErrorCode::empty);
        Points points(4, glm::dvec2(1.0));
        points[2].x = std::numeric_limits<double>::quiet_NaN();
        CHECK(fit::minimal_rectangle(view(points), PlanarCriterion::area).error().item == 2);
        CHECK(fit::minimal_disc(view(points)).error().item == 2);
        points[1].y = 1e31;
        CHECK(fit::minimal_disc(view(points)).error().code == ErrorCode::out_of_range);
    }

    TEST_CASE("a point and a segment have rectangles and discs of no more than their size") {
        const Points point(3, glm::dvec2(1e8, -3.0));
        CHECK(fit::minimal_rectangle(view(point), PlanarCriterion::area)->half_extents == glm::dvec2(0.0));
        CHECK(fit::minimal_disc(view(point))->radius == 0.0);
        const Points flat = {{0.0, 2.0}, {3.0, 2.0}, {1.0, 2.0}};
        const Rectangle r = fit::minimal_rectangle(view(flat), PlanarCriterion::perimeter).value();
        CHECK(perimeter(r) == doctest::Approx(6.0).epsilon(1e-15));
        CHECK(area(r) == 0.0);
        CHECK(fit::minimal_disc(view(flat))->radius == doctest::Approx(1.5).epsilon(1e-15));
    }

    TEST_CASE("known figures: an equilateral triangle, a regular hexagon") {
        const double h = std::sqrt(3.0) / 2.0;
        const Points triangle = {{0.0, 0.0}, {1.0, 0.0}, {0.5, h}};
        CHECK(area(fit::minimal_rectangle(view(triangle), PlanarCriterion::area).value()) ==
              doctest::Approx(h).epsilon(1e-14));
        CHECK(perimeter(fit::minimal_rectangle(view(triangle), PlanarCriterion::perimeter).value()) ==
              doctest::Approx(2.0 + 2.0 * h).epsilon(1e-14));
        CHECK(fit::minimal_disc(view(triangle))->radius == doctest::Approx(1.0 / std::sqrt(3.0)).epsilon(1e-14));
        Points hexagon;
        for (int i = 0; i < 6; ++i)
            hexagon.emplace_back(std::cos(i * std::numbers::pi / 3.0), std::sin(i * std::numbers::pi / 3.0));
        CHECK(area(fit::minimal_rectangle(view(hexagon), PlanarCriterion::area).value()) ==
              doctest::Approx(4.0 * h).epsilon(1e-14));
        CHECK(fit::minimal_disc(view(hexagon))->radius == doctest::Approx(1.0).epsilon(1e-14));
    }

    TEST_CASE("rectangles contain every point and no direction of a fine grid does better") {
        std::mt19937 random(1);
        std::normal_distribution<double> normal;
        for (int run = 0; run < 200; ++run) {
            const double scale = std::pow(10.0, run % 48 - 27), offset = run % 3 == 0 ? 1e6 : 0.0;
            Points points;
            for (int i = 0; i < 3 + run % 40; ++i)
                points.push_back(
                    (glm::dvec2(3.0 * normal(random) + normal(random), normal(random)) + glm::dvec2(offset)) * scale);
            for (const auto criterion : {PlanarCriterion::area, PlanarCriterion::perimeter}) {
                const Rectangle r = fit::minimal_rectangle(view(points), criterion).value();
                for (const glm::dvec2& p : points) CHECK(contains(r, p));
                CHECK(measure_of(r, criterion) <= by_brute_force(points, criterion, 2000) * (1.0 + 1e-9));
            }
        }
    }

    TEST_CASE("discs contain every point and are the smallest through two or three of them") {
        std::mt19937 random(2);
        std::normal_distribution<double> normal;
        for (int run = 0; run < 200; ++run) {
            Points points;
            for (int i = 0; i < 2 + run % 12; ++i) points.emplace_back(normal(random), normal(random));
            const Disc disc = fit::minimal_disc(view(points)).value();
            for (const glm::dvec2& p : points) CHECK(contains(disc, p));
            // Brute force: the largest over all pairs and triples of the smallest disc around them alone (Helly).
            double needed = 0.0;
            for (const glm::dvec2& a : points)
                for (const glm::dvec2& b : points)
                    for (const glm::dvec2& c : points) {
                        double sides[3] = {glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)};
                        std::sort(sides, sides + 3);
                        const bool obtuse = sides[2] * sides[2] >= sides[0] * sides[0] + sides[1] * sides[1];
                        const double twice_area = std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
                        needed = std::max(
                            needed, obtuse ? 0.5 * sides[2] : sides[0] * sides[1] * sides[2] / (2.0 * twice_area));
                    }
            CHECK(disc.radius == doctest::Approx(needed).epsilon(1e-9));
        }
    }
}
