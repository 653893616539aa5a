// SPDX-License-Identifier: MIT
// The farthest points of a cloud along three directions: found by floats that round, and decided in double.
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>
#include <vector>

#include "cloud/point_cloud.hpp"

using namespace crofton;

TEST_SUITE("fit/point_cloud") {
    TEST_CASE("the support point is the farther of two almost equally far points in different chunks") {
        std::mt19937_64 random(50);
        std::uniform_real_distribution<double> number(-1.0, 1.0);
        const auto vector = [&] { return glm::dvec3(number(random), number(random), number(random)); };
        fit::PointCloud cloud;
        std::vector<glm::vec3> points(256, glm::vec3(0.0f));
        int near = 0;
        for (int trial = 0; trial < 20000; ++trial) {
            glm::dmat3 axes;
            axes[0] = glm::normalize(vector());
            axes[1] = glm::normalize(glm::cross(axes[0], vector()));
            axes[2] = glm::cross(axes[0], axes[1]);
            const glm::dvec3 up = 0.6 * axes[trial % 3], aside = 0.75 * axes[(trial + 1) % 3];
            const glm::dvec3 place = trial % 4 == 3 ? 64.0 * vector() : glm::dvec3(0.0);
            // Both as far along one axis, but for their rounding to floats; all else is at the middle.
            for (glm::vec3& p : points) p = glm::vec3(place);
            points[5] = glm::vec3(place + up + aside);
            points[200] = glm::vec3(place + up - aside);
            REQUIRE(cloud.assign(points).has_value());
            const fit::Supports supports = cloud.supports(axes);
            const auto normalised = [&](std::size_t i) {
                return (glm::dvec3(points[i]) - cloud.origin()) / cloud.unit();
            };
            const std::size_t k = static_cast<std::size_t>(trial % 3);
            const glm::dvec3 first = normalised(5), second = normalised(200), along = axes[trial % 3];
            const double apart = glm::dot(first - second, along);
            if (std::abs(apart) < 1e-13) continue;
            near += std::abs(apart) < 0x1p-24;
            REQUIRE(supports[2 * k] == (apart > 0.0 ? first : second));
        }
        CHECK(near > 1000);
    }

    TEST_CASE(
        "where chunks are cells of a long cloud and most are skipped, the support points are those of all points") {
        std::mt19937_64 random(51);
        std::uniform_real_distribution<double> number(0.0, 1.0);
        fit::PointCloud cloud;
        std::vector<glm::vec3> points;
        for (int trial = 0; trial < 60; ++trial) {
            glm::dmat3 directions;
            directions[0] = glm::normalize(glm::dvec3(1.0, 0.4 * number(random), 0.4 * number(random)));
            directions[1] =
                glm::normalize(glm::cross(glm::dvec3(0.4 * number(random), 0.4 * number(random), 1.0), directions[0]));
            directions[2] = glm::cross(directions[0], directions[1]);
            // 5 x 5 x 5 cells of 128 points, shorter along one axis than along the next.
            glm::dvec3 size;
            for (int k = 0; k < 3; ++k) size[(k + trial) % 3] = std::pow(3.0, trial % 2 == 0 ? k : -k);
            const glm::dvec3 shift = 0.3 * size * glm::dvec3(number(random), number(random), number(random));
            points.clear();
            for (int cell = 0; cell < 125; ++cell)
                for (int i = 0; i < 128; ++i) {
                    const glm::dvec3 at(cell % 5, cell / 5 % 5, cell / 25);
                    const glm::dvec3 within(number(random), number(random), number(random));
                    points.emplace_back(shift + size * ((at + within) / 5.0 - 0.5));
                }
            REQUIRE(cloud.assign(points).has_value());
            const fit::Supports supports = cloud.supports(directions);
            for (std::size_t side = 0; side < 6; ++side) {
                const glm::dvec3 along = (side % 2 == 0 ? 1.0 : -1.0) * directions[static_cast<int>(side / 2)];
                double farthest = -HUGE_VAL;
                for (const glm::vec3& p : points)
                    farthest = std::max(farthest, glm::dot((glm::dvec3(p) - cloud.origin()) / cloud.unit(), along));
                CAPTURE(trial);
                CAPTURE(side);
                CHECK(glm::dot(supports[side], along) == doctest::Approx(farthest).epsilon(1e-14));
            }
        }
    }
}
