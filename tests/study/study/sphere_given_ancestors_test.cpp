// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/spatial_lines.hpp>
#include <crofton/study/sphere_given_ancestors.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

using namespace crofton;
using std::numbers::pi;

namespace {

// M of the hull of two spheres, radii 1 and r, centres d apart: 4π × the mean of max(1, r + d·t) over t in [−1, 1].
double hull_of_spheres(double r, double d) {
    const double t = std::clamp((1.0 - r) / d, -1.0, 1.0);
    return 4.0 * pi * 0.5 * ((t + 1.0) + r * (1.0 - t) + 0.5 * d * (1.0 - t * t));
}

}  // namespace

TEST_SUITE("study/sphere_given_ancestors") {
    TEST_CASE("no points, NaN, no ancestors, objects that stick out and bad options are refused") {
        const std::vector<study::ConvexBody> sphere = {study::ConvexBody::sphere(glm::dvec3(0.0), 1.0)};
        const std::vector<glm::dvec3> inside = {{0, 0, 0}, {0.5, 0, 0}}, outside = {{0, 0, 0}, {1.5, 0, 0}},
                                      nan = {{0, 0, 0}, {std::nan(""), 0, 0}};
        CHECK(error_of(study::sphere_given_ancestors({}, sphere)).code == ErrorCode::empty);
        CHECK(error_of(study::sphere_given_ancestors(nan, sphere)).item == 1);
        CHECK(error_of(study::sphere_given_ancestors(inside, {})).code == ErrorCode::empty);
        CHECK(error_of(study::sphere_given_ancestors(outside, sphere)).code == ErrorCode::invalid_argument);
        CHECK_FALSE(study::sphere_given_ancestors(inside, sphere, {.largest = 0.5}).has_value());
        CHECK_FALSE(study::sphere_given_ancestors(inside, sphere, {.tolerance = 0.0}).has_value());
    }

    TEST_CASE("the paper's example in space: a segment in its sphere, the best second sphere by the closed form") {
        const std::vector<glm::dvec3> segment = {{-1, 0, 0}, {1, 0, 0}};
        const std::vector<study::ConvexBody> first = {study::ConvexBody::sphere(glm::dvec3(0.0), 1.0)};
        const auto best = study::sphere_given_ancestors(segment, first, {.largest = 4.0, .tolerance = 3e-3});
        REQUIRE(best.has_value());
        // Spheres through both ends: radius R, centre √(R² − 1) away. Two bodies that meet: M₁ + M₂ − M_hull.
        double least = 4.0 * pi;
        for (double radius = 1.0; radius <= 4.0; radius += 1e-3) {
            const double away = std::sqrt(std::max(1e-18, radius * radius - 1.0));
            least = std::min(least, 4.0 * pi * (1.0 + radius) - hull_of_spheres(radius, away));
        }
        CHECK(best->plain_value == doctest::Approx(4.0 * pi).epsilon(1e-3));
        CHECK(best->value == doctest::Approx(least).epsilon(5e-3));
        CHECK(best->value < 0.98 * best->plain_value);
        CHECK(best->lower_bound <= best->value);
        CHECK(best->lower_bound >= best->value * (1.0 - 3.1e-3));
        CHECK(glm::distance(best->sphere.center, segment[0]) <= best->sphere.radius * (1.0 + 1e-12));
        CHECK(glm::distance(best->sphere.center, segment[1]) <= best->sphere.radius * (1.0 + 1e-12));
    }

    TEST_CASE("the measures are the same far from the origin") {
        const glm::dvec3 away(1e6, -2e6, 3e5);
        std::vector<glm::dvec3> here = {{0, 0, 0}, {1, 0, 0}, {0, 0.5, 0.25}}, there = here;
        for (glm::dvec3& p : there) p += away;
        const std::vector<study::ConvexBody> near = {study::ConvexBody::sphere({0.5, 0.25, 0.0}, 1.5)},
                                             far = {study::ConvexBody::sphere(away + glm::dvec3(0.5, 0.25, 0.0), 1.5)};
        const auto a = study::sphere_given_ancestors(here, near, {.tolerance = 0.05});
        const auto b = study::sphere_given_ancestors(there, far, {.tolerance = 0.05});
        REQUIRE(a.has_value());
        REQUIRE(b.has_value());
        CHECK(b->value == doctest::Approx(a->value).epsilon(1e-6));
        CHECK(b->plain_value == doctest::Approx(a->plain_value).epsilon(1e-6));
        CHECK(b->lower_bound == doctest::Approx(a->lower_bound).epsilon(1e-6));
        for (const glm::dvec3& p : there) CHECK(glm::distance(p, b->sphere.center) <= b->sphere.radius);
    }

    TEST_CASE("no sphere that a random search finds lies below the bound, by the quadrature of theory.md (4)") {
        for (std::uint64_t seed = 0; seed < 4; ++seed) {
            sampling::Random random(26, seed);
            std::vector<glm::dvec3> points;
            for (int i = 0; i < 6; ++i)
                points.push_back(glm::dvec3(1.0, 0.4, 0.3) * sampling::ball_point(random.point<3>()));
            const std::vector<study::ConvexBody> ancestors = {
                study::ConvexBody::sphere(0.2 * sampling::ball_point(random.point<3>()), 1.3)};
            const auto best = study::sphere_given_ancestors(points, ancestors, {.largest = 4.0, .max_cells = 4000});
            REQUIRE(best.has_value());
            CHECK(best->value <= best->plain_value);
            CHECK(best->lower_bound > 0.5 * best->value);
            for (int i = 0; i < 60; ++i) {
                const glm::dvec3 center = 2.0 * sampling::ball_point(random.point<3>());
                double radius = 0.0;
                for (const glm::dvec3& p : points) radius = std::max(radius, glm::distance(p, center));
                const std::vector<study::ConvexBody> both = {ancestors[0], study::ConvexBody::sphere(center, radius)};
                CHECK(measure_of_planes_hitting_all(both, {.tolerance = 1e-3})->value >=
                      best->lower_bound * (1.0 - 2e-3));
            }
        }
    }
}
