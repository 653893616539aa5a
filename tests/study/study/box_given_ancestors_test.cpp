// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/fit/fit.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/bound_given_ancestors.hpp>
#include <crofton/study/spatial_lines.hpp>
#include <numbers>
#include <utility>
#include <vector>

#include "ancestor_directions.hpp"
#include "box_search.hpp"
#include "rotation_cells.hpp"

using namespace crofton;

namespace {

std::vector<glm::dvec3> random_points(std::uint64_t seed, int count, const glm::dvec3& size) {
    sampling::Random random(31, seed);
    std::vector<glm::dvec3> points;
    for (int i = 0; i < count; ++i)
        points.push_back(glm::dvec3(4.0, -2.0, 1.0) + size * sampling::ball_point(random.point<3>()));
    return points;
}

// Boxes of other orientations around the points, as upper levels have them.
std::vector<study::ConvexBody> loose_ancestors(const std::vector<glm::dvec3>& points, std::uint64_t seed, int count) {
    std::vector<study::ConvexBody> bodies;
    sampling::Random random(32, seed);
    for (int i = 0; i < count; ++i) {
        Obb box =
            *fit::fit_oriented(std::span<const glm::dvec3>(points), glm::mat3(sampling::rotation(random.point<3>())));
        box.half_extents *= 1.05f;
        bodies.push_back(study::ConvexBody::box(box));
    }
    return bodies;
}

double measure_of(const std::vector<study::ConvexBody>& ancestors, const Obb& box) {
    std::vector<study::ConvexBody> bodies = ancestors;
    bodies.push_back(study::ConvexBody::box(box));
    return study::measure_of_planes_hitting_all(bodies, {.tolerance = 2e-4, .max_cells = 200'000})->value;
}

}  // namespace

TEST_SUITE("study/box_given_ancestors") {
    TEST_CASE("no points, a single one, bad options and objects that stick out are refused") {
        const auto points = random_points(1, 10, glm::dvec3(1.0));
        const std::vector<study::ConvexBody> far = {study::ConvexBody::sphere(glm::dvec3(0.0), 1.0)},
                                             huge = {study::ConvexBody::sphere(glm::dvec3(0.0), 100.0)};
        CHECK(study::box_given_ancestors({}, huge).error().code == ErrorCode::empty);
        CHECK(study::box_given_ancestors(points, {}).error().code == ErrorCode::empty);
        CHECK(study::box_given_ancestors(points, far).error().code == ErrorCode::invalid_argument);
        CHECK(study::box_given_ancestors(points, huge, {.tolerance = 0.0}).error().code == ErrorCode::invalid_argument);
        const std::vector<glm::dvec3> point(3, glm::dvec3(1.0));
        CHECK(study::box_given_ancestors(point, huge).error().code == ErrorCode::degenerate);
        auto broken = points;
        broken[4].y = std::nan("");
        CHECK(study::box_given_ancestors(broken, huge).error().item == 4);
    }

    TEST_CASE("ancestors that say nothing leave the box of least edge sum, which another proof gives") {
        for (std::uint64_t seed = 0; seed < 3; ++seed) {
            const auto points = random_points(seed, 14, {1.0, 0.6, 0.3});
            const std::vector<study::ConvexBody> huge = {study::ConvexBody::sphere(glm::dvec3(0.0), 100.0)};
            const auto found = study::box_given_ancestors(points, huge, {.tolerance = 2e-2, .max_cells = 20'000});
            REQUIRE(found.has_value());
            const auto exact =
                fit::fit_exact(std::span<const glm::dvec3>(points), {.criterion = measure::minimal_perimeter()});
            const double least =
                measure::intrinsic_volumes_of_box(exact->box).mean_curvature;  // what planes see of the best box
            CHECK(found->lower_bound <= least * (1.0 + 2e-3));
            CHECK(found->value >= least * (1.0 - 2e-3));
            CHECK(found->value <= least * 1.03);
            CHECK(found->lower_bound >= 0.95 * found->value);
        }
    }

    TEST_CASE("no orientation in a cell has less than the cell's bound, which comes close to the least of them") {
        int close = 0, cells = 0;
        for (std::uint64_t seed = 0; seed < 12; ++seed) {
            const auto points = random_points(seed, 12, {1.0, 0.5, 0.4});
            const auto ancestors = loose_ancestors(points, seed, 1 + static_cast<int>(seed % 2));
            const study::AncestorDirections directions(ancestors);
            glm::dvec3 origin(0.0);
            for (const glm::dvec3& p : points) origin += p / static_cast<double>(points.size());
            Vector<glm::dvec3> relative;
            for (const glm::dvec3& p : points) relative.push_back(p - origin);
            const study::BoxSearch search(std::move(relative), origin, directions);
            sampling::Random random(34, seed);
            for (int cell = 0; cell < 12; ++cell) {
                const glm::dvec3 center = 0.4 * sampling::ball_point(random.point<3>());
                const double half = 1e-3 * std::pow(4.0, cell % 4), bound = search.bound(center, half);
                const double middle = search.measure_of(study::rotation_of(center));
                double least = middle;
                for (int i = 0; i < 40; ++i) {
                    // The corners, and places within.
                    glm::dvec3 at = center;
                    for (int k = 0; k < 3; ++k)
                        at[k] += half * (i < 8 ? ((i >> k & 1) != 0 ? 1.0 : -1.0) : random.uniform(-1.0, 1.0));
                    least = std::min(least, search.measure_of(study::rotation_of(at)));
                }
                CHECK(bound <= least);
                // What is of first order is not lost.
                ++cells;
                close += least - bound < 0.5 * (middle - least);
            }
        }
        CHECK(close > cells / 4);
    }

    TEST_CASE("no turned box is below the bound, and the value is that of an adaptive quadrature with its own proof") {
        int better = 0;
        for (std::uint64_t seed = 0; seed < 4; ++seed) {
            const auto points = random_points(seed, 12, {1.0, 0.5, 0.4});
            const auto ancestors = loose_ancestors(points, seed, 1 + static_cast<int>(seed % 2));
            const auto found = study::box_given_ancestors(points, ancestors, {.tolerance = 3e-2, .max_cells = 20'000});
            REQUIRE(found.has_value());
            for (const glm::dvec3& p : points) CHECK(contains(found->box, p));
            CHECK(found->value <= found->plain_value);
            CHECK(found->lower_bound <= found->value);
            CHECK(found->lower_bound >= 0.9 * found->value);
            better += found->value < 0.999 * found->plain_value;
            CHECK(measure_of(ancestors, found->box) == doctest::Approx(found->value).epsilon(4e-3));
            sampling::Random random(33, seed);
            for (int i = 0; i < 150; ++i) {
                const auto box = fit::fit_oriented(std::span<const glm::dvec3>(points),
                                                   glm::mat3(sampling::rotation(random.point<3>())));
                CHECK(measure_of(ancestors, *box) >= found->lower_bound * (1.0 - 3e-3));
            }
        }
        CHECK(better >= 1);
    }
}
