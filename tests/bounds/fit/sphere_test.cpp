// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/fit/fit.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <random>
#include <vector>

using namespace crofton;

namespace {

using Points = std::vector<glm::dvec3>;

Result<Sphere> sphere_of(const Points& points) {
    return fit::minimal_sphere(points);
}

double farthest(const Points& points, const glm::dvec3& center) {
    double r = 0.0;
    for (const glm::dvec3& p : points) r = std::max(r, glm::distance(p, center));
    return r;
}

// In extended precision: rounding of the test itself must not matter.
bool contains(const Sphere& sphere, const glm::dvec3& p) {
    long double square = 0.0L;
    for (int k = 0; k < 3; ++k) {
        const long double d = static_cast<long double>(p[k]) - static_cast<long double>(sphere.center[k]);
        square += d * d;
    }
    return std::sqrt(square) <= static_cast<long double>(sphere.radius);
}

// Downhill by ever smaller random steps: the radius is a convex function of the centre.
double by_descent(const Points& points) {
    std::mt19937_64 random(2);
    std::normal_distribution<double> normal;
    glm::dvec3 center = points[0];
    double best = farthest(points, center);
    for (double step = 2.0; step > 1e-9; step *= 0.995) {
        const glm::dvec3 next = center + step * best * glm::dvec3(normal(random), normal(random), normal(random));
        if (const double r = farthest(points, next); r < best) best = r, center = next;
    }
    return best;
}

}  // namespace

TEST_SUITE("fit/sphere") {
    TEST_CASE("no points and bad points are refused by their first index") {
        CHECK(error_of(fit::minimal_sphere({})).code == ErrorCode::empty);
        Points points(4, glm::dvec3(1.0));
        points[2].y = std::nan("");
        CHECK(error_of(sphere_of(points)).item == 2);
        points[1].z = -2e30;
        CHECK(error_of(sphere_of(points)).code == ErrorCode::out_of_range);
    }

    TEST_CASE("a point, a segment, a regular tetrahedron and a box far away have the spheres one knows") {
        CHECK(sphere_of(Points(3, glm::dvec3(7.0)))->radius == 0.0);
        const auto segment = sphere_of({{0, 0, 0}, {1, 2, 2}, {0.3, 0.6, 0.6}});
        CHECK(segment->radius == doctest::Approx(1.5).epsilon(1e-12));
        CHECK(glm::distance(segment->center, glm::dvec3(0.5, 1.0, 1.0)) < 1e-12);
        CHECK(sphere_of({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}})->radius ==
              doctest::Approx(std::sqrt(3.0)).epsilon(1e-12));
        // An obtuse triangle: the sphere of its longest side.
        CHECK(sphere_of({{0, 0, 0}, {10, 0, 0}, {4, 1, 0}})->radius == doctest::Approx(5.0).epsilon(1e-12));
        Points box;
        for (int c = 0; c < 8; ++c)
            box.push_back(glm::dvec3(1e6) + glm::dvec3(c & 1 ? 1 : -1, c & 2 ? 2 : -2, c & 4 ? 3 : -3));
        CHECK(sphere_of(box)->radius == doctest::Approx(std::sqrt(14.0)).epsilon(1e-9));
    }

    TEST_CASE("contains every point, and no search downhill finds a smaller one") {
        for (int trial = 0; trial < 150; ++trial) {
            std::mt19937_64 random(static_cast<std::uint64_t>(trial));
            std::uniform_real_distribution<double> uniform(-1.0, 1.0);
            Points points;
            for (int i = 0; i < 2 + trial % 40; ++i) {
                glm::dvec3 p(uniform(random), uniform(random), uniform(random));
                if (trial % 4 == 0) p = glm::normalize(p);    // all on a sphere
                if (trial % 4 == 1) p.z = 0.0;                // flat
                if (trial % 4 == 2) p = glm::round(2.0 * p);  // many at one distance, many equal
                points.push_back(1e3 * p + glm::dvec3(trial % 7 == 0 ? 1e5 : 0.0));
            }
            const auto sphere = sphere_of(points).value();
            CHECK(farthest(points, sphere.center) <= sphere.radius);
            for (const glm::dvec3& p : points) CHECK(contains(sphere, p));
            CHECK(sphere.radius <= by_descent(points) * (1.0 + 1e-8));
        }
    }
}
