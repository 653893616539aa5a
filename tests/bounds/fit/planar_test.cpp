// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/fit/fit.hpp>
#include <crofton/geometry/predicates.hpp>
#include <error_of.hpp>
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

using Corners = std::array<glm::dvec2, 3>;

double cross(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

double measure_of(const Corners& t, PlanarCriterion criterion) {
    return criterion == PlanarCriterion::area
               ? 0.5 * cross(t[1] - t[0], t[2] - t[0])
               : glm::distance(t[0], t[1]) + glm::distance(t[1], t[2]) + glm::distance(t[2], t[0]);
}

bool contains(const Corners& t, const glm::dvec2& p) {
    for (std::size_t k = 0; k < 3; ++k)
        if (orientation(t[k], t[(k + 1) % 3], p) < 0) return false;
    return true;
}

// The triangle with sides across three directions, given by angles; infinite where they do not close.
double triangle_across(const Points& points, PlanarCriterion criterion, const std::array<double, 3>& angles) {
    glm::dvec2 normal[3];
    double support[3];
    for (int k = 0; k < 3; ++k) {
        normal[k] = {std::cos(angles[std::size_t(k)]), std::sin(angles[std::size_t(k)])};
        support[k] = -1e300;
        for (const glm::dvec2& p : points) support[k] = std::max(support[k], glm::dot(p, normal[k]));
    }
    Corners corners;
    for (int k = 0; k < 3; ++k) {
        const int j = (k + 1) % 3;
        const double sine = cross(normal[k], normal[j]);
        if (sine <= 1e-6) return 1e300;
        corners[std::size_t(k)] = glm::dvec2(support[k] * normal[j].y - support[j] * normal[k].y,
                                             support[j] * normal[k].x - support[k] * normal[j].x) /
                                  sine;
    }
    return measure_of(corners, criterion);
}

// The least of the triangles with sides in three of `steps` directions, then downhill by ever smaller random turns.
double triangle_by_brute_force(const Points& points, PlanarCriterion criterion, int steps) {
    std::array<double, 3> best{};
    double least = 1e300;
    const auto angle = [&](int i) { return 2.0 * std::numbers::pi * i / steps; };
    const auto consider = [&](const std::array<double, 3>& angles) {
        if (const double value = triangle_across(points, criterion, angles); value < least)
            least = value, best = angles;
    };
    for (int i = 0; i < steps; ++i)
        for (int j = i + 1; j < steps && 2 * (j - i) < steps; ++j)
            for (int k = j + 1; k < steps && 2 * (k - j) < steps; ++k)
                if (2 * (k - i) > steps) consider({angle(i), angle(j), angle(k)});
    std::mt19937_64 random(9);
    std::uniform_real_distribution<double> turn(-1.0, 1.0);
    for (double size = 0.2; size > 1e-9; size *= 0.97)
        for (int n = 0; n < 4; ++n)
            consider({best[0] + size * turn(random), best[1] + size * turn(random), best[2] + size * turn(random)});
    return least;
}

}  // namespace

TEST_SUITE("fit/planar") {
    TEST_CASE("no points and bad points are refused by their first index") {
        CHECK(error_of(fit::minimal_rectangle({}, PlanarCriterion::area)).code == ErrorCode::empty);
        CHECK(error_of(fit::minimal_disc({})).code == ErrorCode::empty);
        Points points(4, glm::dvec2(1.0));
        points[2].x = std::numeric_limits<double>::quiet_NaN();
        CHECK(error_of(fit::minimal_rectangle(view(points), PlanarCriterion::area)).item == 2);
        CHECK(error_of(fit::minimal_disc(view(points))).item == 2);
        points[1].y = 1e31;
        CHECK(error_of(fit::minimal_disc(view(points))).code == ErrorCode::out_of_range);
        for (int k = 0; k < 2; ++k)
            for (const double bad :
                 {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
                Points corners = {{0.0, 0.0}, {2.0, 0.0}, {1.0, 1.0}};
                corners[1][k] = bad;
                const auto refused = fit::minimal_rectangle_of_convex(view(corners), PlanarCriterion::area);
                CHECK(error_of(refused).code == ErrorCode::non_finite);
                CHECK(error_of(refused).item == 1);
                CHECK(error_of(fit::minimal_disc(view(corners))).code == ErrorCode::non_finite);
            }
    }

    TEST_CASE("points times a power of two have the same rectangle, disc and triangle, scaled, from 1e-90 to 1e29") {
        std::mt19937 random(5);
        std::normal_distribution<double> normal;
        for (int run = 0; run < 60; ++run) {
            Points points, scaled;
            const double scale = std::ldexp(1.0, run % 2 ? -299 : 96);
            for (int i = 0; i < 3 + run % 9; ++i) {
                points.emplace_back(normal(random), normal(random));
                scaled.push_back(scale * points.back());
            }
            const Disc disc = *fit::minimal_disc(view(points)), large = *fit::minimal_disc(view(scaled));
            CHECK(large.center == scale * disc.center);
            CHECK(large.radius == scale * disc.radius);
            for (const auto criterion : {PlanarCriterion::area, PlanarCriterion::perimeter}) {
                const auto first = *fit::minimal_rectangle(view(points), criterion);
                const auto second = *fit::minimal_rectangle(view(scaled), criterion);
                CHECK(second.center == scale * first.center);
                CHECK(second.axis == first.axis);
                CHECK(second.half_extents == scale * first.half_extents);
                const auto corners = *fit::minimal_triangle(view(points), criterion);
                const auto others = *fit::minimal_triangle(view(scaled), criterion);
                for (std::size_t k = 0; k < 3; ++k) CHECK(others[k] == scale * corners[k]);
            }
        }
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

    TEST_CASE("the rectangle around 200,000 corners of a circle is its square, found in one turn about them") {
        Points points;
        for (int i = 0; i < 200000; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / 200000;
            points.emplace_back(3.0 * std::cos(angle), 3.0 * std::sin(angle));
        }
        CHECK(area(fit::minimal_rectangle(view(points), PlanarCriterion::area).value()) ==
              doctest::Approx(36.0).epsilon(1e-8));
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

    TEST_CASE("triangles: bad points are refused, a point and a segment have no area, and a triangle is its own best") {
        CHECK(error_of(fit::minimal_triangle({}, PlanarCriterion::area)).code == ErrorCode::empty);
        Points points = {{0.0, 0.0}, {4.0, 0.0}, {1.0, 3.0}, {1.5, 1.0}};
        for (const PlanarCriterion criterion : {PlanarCriterion::area, PlanarCriterion::perimeter}) {
            const auto own = fit::minimal_triangle(view(points), criterion).value();
            for (const glm::dvec2& c : own)
                CHECK(std::min({glm::distance(c, points[0]), glm::distance(c, points[1]),
                                glm::distance(c, points[2])}) < 1e-7);
            const Points line = {{0.0, 0.0}, {2.0, 2.0}, {1.0, 1.0}};
            CHECK(measure_of(*fit::minimal_triangle(view(line), PlanarCriterion::area), PlanarCriterion::area) == 0.0);
            const Points point(3, glm::dvec2(7.0));
            CHECK((*fit::minimal_triangle(view(point), criterion))[1] == glm::dvec2(7.0));
        }
        points[3].y = std::numeric_limits<double>::infinity();
        CHECK(error_of(fit::minimal_triangle(view(points), PlanarCriterion::perimeter)).item == 3);
        points[3].y = 2e30;
        CHECK(error_of(fit::minimal_triangle(view(points), PlanarCriterion::area)).code == ErrorCode::out_of_range);
    }

    TEST_CASE(
        "triangles around a square have twice its area, around a regular hexagon 3/2 of its area, and its perimeter") {
        const Points square = {{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};
        CHECK(measure_of(*fit::minimal_triangle(view(square), PlanarCriterion::area), PlanarCriterion::area) ==
              doctest::Approx(2.0).epsilon(1e-12));
        Points hexagon;
        for (int i = 0; i < 6; ++i)
            hexagon.emplace_back(std::cos(std::numbers::pi * i / 3.0), std::sin(std::numbers::pi * i / 3.0));
        const double own = 1.5 * std::sqrt(3.0);
        CHECK(measure_of(*fit::minimal_triangle(view(hexagon), PlanarCriterion::area), PlanarCriterion::area) ==
              doctest::Approx(1.5 * own).epsilon(1e-12));
        // Three of its sides prolonged: an equilateral triangle of side 3.
        CHECK(measure_of(*fit::minimal_triangle(view(hexagon), PlanarCriterion::perimeter),
                         PlanarCriterion::perimeter) == doctest::Approx(9.0).epsilon(1e-12));
        Points disc;
        for (int i = 0; i < 300; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / 300;
            disc.emplace_back(std::cos(angle), std::sin(angle));
        }
        // Around a disc of radius 1: equilateral.
        CHECK(measure_of(*fit::minimal_triangle(view(disc), PlanarCriterion::area), PlanarCriterion::area) ==
              doctest::Approx(3.0 * std::sqrt(3.0)).epsilon(1e-3));
        CHECK(measure_of(*fit::minimal_triangle(view(disc), PlanarCriterion::perimeter), PlanarCriterion::perimeter) ==
              doctest::Approx(6.0 * std::sqrt(3.0)).epsilon(1e-3));
    }

    TEST_CASE("triangles contain every point, one side is flush, and no triangle of a fine grid is smaller") {
        for (int trial = 0; trial < 120; ++trial) {
            std::mt19937_64 random(static_cast<std::uint64_t>(trial));
            std::uniform_real_distribution<double> uniform(-1.0, 1.0);
            const double flat = trial % 4 == 0 ? 0.05 : 1.0;
            Points points;
            for (int i = 0; i < 3 + trial % 17; ++i) {
                glm::dvec2 p(uniform(random), flat * uniform(random));
                if (trial % 3 == 0) p = glm::normalize(p);
                if (trial % 5 == 0) p = glm::round(4.0 * p);  // on a grid: parallel sides, equal heights
                points.push_back(p);
            }
            for (const PlanarCriterion criterion : {PlanarCriterion::area, PlanarCriterion::perimeter}) {
                const auto best = fit::minimal_triangle(view(points), criterion).value();
                for (const glm::dvec2& p : points) CHECK(contains(best, p));
                const double value = measure_of(best, criterion);
                const double grid = triangle_by_brute_force(points, criterion, 36);
                CHECK(value <= grid * (1.0 + 1e-9));
                // Tight: no side can be moved inward, and a slightly smaller triangle loses a point.
                for (std::size_t k = 0; k < 3 && measure_of(best, PlanarCriterion::area) > 1e-9; ++k) {
                    const glm::dvec2 a = best[k], b = best[(k + 1) % 3], side = glm::normalize(b - a);
                    double nearest = 1e300;
                    for (const glm::dvec2& p : points) nearest = std::min(nearest, std::abs(cross(side, p - a)));
                    CHECK(nearest < 1e-7);
                }
            }
        }
    }

    TEST_CASE("triangles contain points that are collinear but for their rounding, and are not much longer") {
        std::mt19937_64 random(23);
        std::uniform_real_distribution<double> uniform(-1.0, 1.0);
        for (int trial = 0; trial < 3000; ++trial) {
            const glm::dvec2 along(uniform(random), uniform(random));
            const double at = trial % 3 == 0 ? 1e5 * uniform(random) : 0.0;
            Points points;
            for (int i = 0; i < 3 + trial % 8; ++i) points.push_back(at + along * uniform(random));
            double longest = 0.0;
            for (const glm::dvec2& p : points)
                for (const glm::dvec2& q : points) longest = std::max(longest, glm::distance(p, q));
            for (const PlanarCriterion criterion : {PlanarCriterion::area, PlanarCriterion::perimeter}) {
                if (criterion == PlanarCriterion::perimeter && trial % 10 != 0) continue;
                const auto best = fit::minimal_triangle(view(points), criterion).value();
                for (const glm::dvec2& p : points) {
                    CHECK(orientation(best[0], best[1], p) >= 0);
                    CHECK(orientation(best[1], best[2], p) >= 0);
                    CHECK(orientation(best[2], best[0], p) >= 0);
                }
                CHECK(measure_of(best, PlanarCriterion::perimeter) <= 8.0 * longest + 1e-9);
            }
        }
    }

    TEST_CASE("by perimeter, points that nearly lie on a line have a triangle of hardly more than twice their length") {
        std::mt19937_64 random(231);
        std::uniform_real_distribution<double> uniform(-1.0, 1.0);
        for (const double thickness :
             {0.0, 1e-17, 1e-16, 1e-15, 1e-14, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3})
            for (int trial = 0; trial < 250; ++trial) {
                const double size = trial % 5 == 0 ? std::ldexp(1.0, trial / 3 - 40) : 1.0;
                const double offset = trial % 3 == 0 ? 0.0 : trial % 3 == 1 ? size : 100.0 * size;
                const double angle = 3.2 * uniform(random);
                const glm::dvec2 along(std::cos(angle), std::sin(angle)), across(-along.y, along.x);
                const glm::dvec2 origin = offset * glm::dvec2(1.0, uniform(random));
                // Its first and last point are alone: a corner at one of them opens by no more than the others' slopes.
                Points points;
                for (int i = 0; i < 3 + trial % 9; ++i) {
                    const double t = i < 2 ? i : 0.5 + 0.4 * uniform(random), d = i < 2 ? 0.0 : uniform(random);
                    points.push_back(origin + size * (t * along + thickness * d * across));
                }
                std::shuffle(points.begin(), points.end(), random);
                double length = 0.0;
                for (const glm::dvec2& p : points)
                    for (const glm::dvec2& q : points) length = std::max(length, glm::distance(p, q));
                const auto best = fit::minimal_triangle(view(points), PlanarCriterion::perimeter).value();
                for (const glm::dvec2& p : points)
                    for (std::size_t k = 0; k < 3; ++k) CHECK(orientation(best[k], best[(k + 1) % 3], p) >= 0);
                const double told = measure_of(best, PlanarCriterion::perimeter);
                const double rounded = thickness * size + 0x1p-52 * (2.0 * offset + size);
                CAPTURE(thickness);
                CAPTURE(trial);
                CHECK(told >= 2.0 * length * (1.0 - 1e-15));
                CHECK(told <= 2.0 * length + 40.0 * rounded);
            }
    }

    TEST_CASE("by perimeter, a thin rectangle has the triangle that calculus finds, up to its thickness") {
        std::mt19937_64 random(232);
        std::uniform_real_distribution<double> uniform(-1.0, 1.0);
        for (const double thickness : {1e-12, 1e-10, 1e-8, 1e-6, 1e-4})
            for (int trial = 0; trial < 60; ++trial) {
                const double angle = 3.2 * uniform(random), offset = trial % 2 ? 3.0 * uniform(random) : 0.0;
                const glm::dvec2 along(std::cos(angle), std::sin(angle)), across(-along.y, along.x);
                Points points;
                for (int i = 0; i < 12; ++i) {
                    const double t = i < 4 ? i / 2 : std::abs(uniform(random)),
                                 d = i < 4 ? i % 2 : std::abs(uniform(random));
                    points.push_back(offset + t * along + thickness * d * across);
                }
                const auto best = fit::minimal_triangle(view(points), PlanarCriterion::perimeter).value();
                // Either one sharp corner, e beyond an end, and the side across as high as the rest asks, or two, each
                // e beyond an end, on one long side: 2 (1 + e) + t (1 + e) / e, or 1 + 2 e + √((1 + 2 e)² + (t / e)²
                // …).
                const double e = std::sqrt(0.5 * thickness), f = std::cbrt(0.25 * thickness * thickness);
                const double height = thickness / f * (0.5 + f);
                const double least = std::min(2.0 * (1.0 + e) + thickness * (1.0 + e) / e,
                                              1.0 + 2.0 * f + 2.0 * std::hypot(0.5 + f, height));
                const double told = measure_of(best, PlanarCriterion::perimeter);
                CAPTURE(thickness);
                CHECK(told <= least + thickness + 1e-9);
                CHECK(told >= least - 4.0 * thickness - 1e-9);
            }
    }
}
