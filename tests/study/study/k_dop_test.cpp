// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/k_dop.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

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
        points[3].x = std::nan("");
        CHECK(error_of(study::k_dop_around(points, axes)).item == 3);
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
            const auto dop = study::k_dop_around(sphere, *study::k_dop_directions(k)).value();
            return measure::intrinsic_volumes_of_hull(dop.corners)->volume;
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

    TEST_CASE("every point is inside, and the corners are those of a body around the points") {
        for (std::uint64_t seed = 0; seed < 12; ++seed) {
            const auto points = random_points(seed, 12);
            for (const std::uint32_t k : {6u, 14u, 18u, 26u}) {
                const auto dop = *study::k_dop_around(points, *study::k_dop_directions(k));
                for (const glm::dvec3& p : points)
                    for (std::size_t i = 0; i < dop.directions.size(); ++i) {
                        CHECK(glm::dot(dop.directions[i], p) >= dop.low[i]);
                        CHECK(glm::dot(dop.directions[i], p) <= dop.high[i]);
                    }
                auto all = dop.corners;
                all.insert(all.end(), points.begin(), points.end());
                CHECK(measure::intrinsic_volumes_of_hull(all)->volume ==
                      doctest::Approx(measure::intrinsic_volumes_of_hull(dop.corners)->volume).epsilon(1e-9));
            }
        }
    }
}
