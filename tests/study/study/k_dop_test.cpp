// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/cull/classify.hpp>
#include <crofton/fit/fit.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/geometry/predicates.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/k_dop.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <vector>

#include "k_dop_search.hpp"
#include "rotation_cells.hpp"

using namespace crofton;

namespace {

std::vector<glm::dvec3> random_points(std::uint64_t seed, int count) {
    sampling::Random random(21, seed);
    std::vector<glm::dvec3> points;
    for (int i = 0; i < count; ++i)
        points.push_back(glm::dvec3(1.0, 0.6, 0.3) * sampling::ball_point(random.point<3>()));
    return points;
}

}  // namespace

TEST_SUITE("study/k_dop") {
    TEST_CASE("unknown k, no points, NaN, zero and flat directions are refused, and the culprit is named") {
        CHECK(error_of(study::k_dop_directions(7)).code == ErrorCode::invalid_argument);
        const auto axes = *study::k_dop_directions(6);
        CHECK(error_of(study::k_dop_around({}, axes)).code == ErrorCode::empty);
        auto points = random_points(1, 5);
        const std::vector<glm::dvec3> flat = {{1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, zero = {{1, 0, 0}, {0, 0, 0}};
        CHECK(error_of(study::k_dop_around(points, flat)).code == ErrorCode::degenerate);
        CHECK(error_of(study::k_dop_around(points, zero)).item == 1);
        CHECK(error_of(study::best_k_dop(points, axes, {})).code == ErrorCode::invalid_argument);
        points[3].x = std::nan("");
        CHECK(error_of(study::k_dop_around(points, axes)).item == 3);
        // Points that are none of the k-DOP's: no hull of it contains them.
        const std::vector<glm::dvec3> beside = {{9.0, 0.0, 0.0}};
        const std::vector<glm::dvec3> corners = {{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}};
        CHECK(error_of(study::hull_around(*study::k_dop_around(corners, axes), beside)).code ==
              ErrorCode::invalid_argument);
        const std::vector<glm::dvec3> unknown = {{0.5, 0.5, 0.5}, {0.5, std::nan(""), 0.5}};
        CHECK(error_of(study::hull_around(*study::k_dop_around(corners, axes), unknown)).code == ErrorCode::non_finite);
        CHECK(error_of(study::hull_around(*study::k_dop_around(corners, axes), unknown)).item == 1);
        const std::vector<glm::dvec3> plane = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
        CHECK(error_of(study::best_k_dop(plane, axes, measure::minimal_area())).code == ErrorCode::degenerate);
    }

    TEST_CASE("k directions: 3, 7, 9 and 13, all unit and none twice") {
        for (const std::uint32_t k : {6u, 14u, 18u, 26u}) {
            const auto directions = *study::k_dop_directions(k);
            CHECK(directions.size() == k / 2);
            for (std::size_t i = 0; i < directions.size(); ++i) {
                CHECK(glm::length(directions[i]) == doctest::Approx(1.0));
                for (std::size_t j = 0; j < i; ++j) CHECK(std::abs(glm::dot(directions[i], directions[j])) < 0.99);
            }
        }
    }

    TEST_CASE(
        "around a sphere of many points: box, truncated shapes, each in the next, V from the closed form of a 14-DOP") {
        std::vector<glm::dvec3> sphere;
        for (int i = 0; i < 20000; ++i)
            sphere.push_back(sampling::direction({(i + 0.5) / 20000, std::fmod(i * 0.6180339887498949, 1.0)}));
        const auto volume = [&](std::uint32_t k) {
            const auto dop = study::k_dop_around(sphere, *study::k_dop_directions(k));
            REQUIRE(dop.has_value());
            return measure::intrinsic_volumes_of_hull(dop->corners)->volume;
        };
        CHECK(volume(6) == doctest::Approx(8.0).epsilon(1e-3));
        // A cube of side 2 less eight corners: x + y + z > √3 cuts off right tetrahedra with legs L = 3 − √3, of which
        // the two of an edge share (L − 1)³/3.
        const double leg = 3.0 - std::sqrt(3.0);
        CHECK(volume(14) ==
              doctest::Approx(8.0 - 8.0 * std::pow(leg, 3.0) / 6.0 + 12.0 * std::pow(leg - 1.0, 3.0) / 3.0)
                  .epsilon(1e-3));
        CHECK(volume(26) < volume(14));
        CHECK(volume(26) < volume(18));
        CHECK(volume(26) > 4.0 / 3.0 * std::numbers::pi);
    }

    TEST_CASE("far from the origin a k-DOP has the corners that it has there") {
        const auto points = random_points(6, 50);
        for (const std::uint32_t k : {14u, 18u, 26u}) {
            const auto directions = *study::k_dop_directions(k);
            const auto near = *study::k_dop_around(points, directions);
            const double volume = measure::intrinsic_volumes_of_hull(near.corners)->volume;
            for (const double offset : {1e6, 1e7, 1e8}) {
                auto moved = points;
                for (glm::dvec3& p : moved) p += glm::dvec3(offset, -0.75 * offset, 0.25 * offset);
                const auto far = *study::k_dop_around(moved, directions);
                CHECK(measure::intrinsic_volumes_of_hull(far.corners)->volume == doctest::Approx(volume).epsilon(1e-5));
            }
        }
    }

    TEST_CASE("every point is inside, no bound undercuts the hull, and six faces cannot beat the best box") {
        for (std::uint64_t seed = 0; seed < 12; ++seed) {
            const auto points = random_points(seed, 12);
            for (const std::uint32_t k : {6u, 14u, 18u, 26u}) {
                const auto best =
                    study::best_k_dop(points, *study::k_dop_directions(k), measure::minimal_area(), {.max_cells = 100});
                REQUIRE(best.has_value());
                for (const glm::dvec3& p : points)
                    for (std::size_t i = 0; i < best->bound.directions.size(); ++i) {
                        const double at = glm::dot(best->bound.directions[i], p);
                        CHECK(at >= best->bound.low[i] - 1e-12);
                        CHECK(at <= best->bound.high[i] + 1e-12);
                    }
                CHECK(best->value >= best->lower_bound);
                // A hull of corners and points is the corners' own: they hold the points.
                auto all = best->bound.corners;
                all.insert(all.end(), points.begin(), points.end());
                CHECK(measure::intrinsic_volumes_of_hull(all)->volume ==
                      doctest::Approx(measure::intrinsic_volumes_of_hull(best->bound.corners)->volume).epsilon(1e-9));
                if (k != 6) continue;
                const auto box =
                    fit::fit_exact(std::span<const glm::dvec3>(points), {.criterion = measure::minimal_area()});
                CHECK(best->value >= box->lower_bound * (1.0 - 1e-9));
            }
        }
    }

    TEST_CASE("the gap is certified: a box's is the proved optimum, and no rotation undercuts the bound") {
        for (std::uint64_t seed = 0; seed < 6; ++seed) {
            const auto points = random_points(seed, 14);
            for (const auto& criterion :
                 {measure::minimal_area(), measure::minimal_volume(), measure::minimal_perimeter()}) {
                const auto box = fit::fit_exact(std::span<const glm::dvec3>(points), {.criterion = criterion});
                const auto six = study::best_k_dop(points, *study::k_dop_directions(6), criterion,
                                                   {.tolerance = 5e-3, .max_cells = 4000});
                CHECK(six->lower_bound <= box->value * (1.0 + 1e-6));
                CHECK(six->lower_bound >= box->lower_bound * (1.0 - 6e-3));
                CHECK(six->value <= box->value * (1.0 + 6e-3));
            }
            const auto directions = *study::k_dop_directions(seed % 2 == 0 ? 14 : 18);
            const auto by_edges = study::best_k_dop(points, directions, measure::minimal_perimeter());
            const auto by_area =
                study::best_k_dop(points, directions, measure::minimal_area(), {.tolerance = 0.05, .max_cells = 10000});
            CHECK(by_edges->value - by_edges->lower_bound <= 0.01 * by_edges->value);
            CHECK(by_area->value - by_area->lower_bound <= 0.05 * by_area->value);
            sampling::Random random(5, seed);
            for (int turn = 0; turn < 200; ++turn) {
                const glm::dmat3 rotation = sampling::rotation(random.point<3>());
                std::vector<glm::dvec3> turned;
                for (const glm::dvec3& d : directions) turned.push_back(rotation * d);
                const auto volumes = measure::intrinsic_volumes_of_hull(study::k_dop_around(points, turned)->corners);
                CHECK(volumes->area >= by_area->lower_bound);
                CHECK(volumes->mean_curvature >= by_edges->lower_bound);
            }
        }
        CHECK(error_of(study::best_k_dop(random_points(1, 5), *study::k_dop_directions(6), measure::minimal_area(),
                                         {.tolerance = 0.0}))
                  .code == ErrorCode::invalid_argument);
    }

    TEST_CASE("no rotation of a cell has less than the cell's bound, also where all supports turn away at once") {
        int close = 0;
        for (std::uint64_t seed = 0; seed < 60; ++seed) {
            const auto directions = *study::k_dop_directions(seed % 2 == 0 ? 14 : 18);
            auto points = random_points(seed, 10);
            if (seed % 3 == 0) {  // where nothing is turned each point is the support of one direction
                points.clear();
                for (const glm::dvec3& d : directions) points.insert(points.end(), {d, -d});
            }
            const measure::Criterion criterion = seed % 5 < 2   ? measure::minimal_area()
                                                 : seed % 5 < 4 ? measure::minimal_perimeter()
                                                                : measure::minimal_volume();
            study::KDopRotations rotations(points, directions, criterion);
            sampling::Random random(24, seed);
            const double half = 0.3 * std::pow(0.5, random.uniform(0.0, 8.0));
            const glm::dvec3 center = seed % 6 == 0 ? glm::dvec3(0.0)
                                                    : glm::dvec3(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3),
                                                                 random.uniform(-0.3, 0.3));
            const glm::dmat3 middle = study::rotation_of(center);
            const double value = rotations.value(middle), bound = rotations.bound(center, half, middle);
            CHECK(bound <= value);
            for (unsigned i = 0; i < 200; ++i) {
                const glm::dvec3 part(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
                const glm::dvec3 g = i < 8 ? study::corner_of(center, half, i) : center + half * part;
                const double there = rotations.value(study::rotation_of(g));
                CHECK(there >= bound);
                close += there - bound < 0.3 * (value - bound) ? 1 : 0;
            }
        }
        CHECK(close > 10);  // the bound is nearly reached
    }

    TEST_CASE("directions of one's own are searched over all rotations, not a cube's share of them") {
        // Slabs of a skewed frame around a parallelepiped of the same frame, turned far: only that rotation fits.
        const std::vector<glm::dvec3> directions = {
            {1, 0, 0}, glm::normalize(glm::dvec3(0.5, 1, 0)), glm::normalize(glm::dvec3(0.2, 0.4, 1))};
        const glm::dmat3 far = sampling::rotation({0.31, 0.77, 0.12});
        const glm::dmat3 rows = glm::transpose(glm::dmat3(directions[0], directions[1], directions[2]));
        std::vector<glm::dvec3> points;
        for (unsigned c = 0; c < 8; ++c)
            points.push_back(
                far * (glm::inverse(rows) * glm::dvec3(c & 1 ? 1.0 : -1.0, c & 2 ? 0.6 : -0.6, c & 4 ? 0.3 : -0.3)));
        const auto own = measure::intrinsic_volumes_of_hull(points)->volume;
        const auto best = study::best_k_dop(points, directions, measure::minimal_volume(), {.max_cells = 20000});
        CHECK(best->value == doctest::Approx(own).epsilon(0.02));
        CHECK(best->lower_bound <= own * (1.0 + 1e-9));
    }

    TEST_CASE("the body that culling takes contains every point exactly, a millionth larger, and loses none of them") {
        Camera camera;
        camera.far_distance = 50.0;
        const Frustum frustum = *frustum_of(camera);
        for (std::uint64_t seed = 0; seed < 300; ++seed) {
            sampling::Random random(22, seed);
            auto points = random_points(seed, 8);
            const glm::dvec3 at(random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(-40, 10));
            for (glm::dvec3& p : points) p += at;
            const auto dop = study::k_dop_around(points, *study::k_dop_directions(seed % 2 == 0 ? 14 : 26));
            const auto body = study::hull_around(*dop, points);
            REQUIRE(body.has_value());
            const auto indices = body->triangles();
            for (std::size_t t = 0; t < indices.size(); t += 3)
                for (const glm::dvec3& p : points) {
                    const auto corner = [&](std::size_t k) { return glm::dvec3(body->vertices()[indices[t + k]]); };
                    CHECK(orientation(corner(0), corner(1), corner(2), p) >= 0);
                }
            for (const glm::vec3& v : body->vertices())
                for (std::size_t i = 0; i < dop->directions.size(); ++i) {
                    CHECK(glm::dot(dop->directions[i], glm::dvec3(v)) <= dop->high[i] + 1e-4);
                    CHECK(glm::dot(dop->directions[i], glm::dvec3(v)) >= dop->low[i] - 1e-4);
                }
            const cull::Verdict verdict = cull::classify(frustum, *body);
            for (std::size_t i = 0; i + 2 < points.size(); ++i) {
                const bool meets = intersects(frustum, points[i], points[i + 1], points[i + 2]);
                if (verdict == cull::Verdict::outside) CHECK_FALSE(meets);
                if (verdict == cull::Verdict::inside) CHECK(meets);
            }
        }
        CHECK(study::hull_around(*study::k_dop_around(random_points(1, 5), *study::k_dop_directions(6)), {})
                  .error()
                  .code == ErrorCode::empty);
    }
}
