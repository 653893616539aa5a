// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/sampling/sampling.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

using namespace crofton;
using namespace crofton::sampling;

TEST_SUITE("sampling/random_motion") {
    TEST_CASE("the corners of the unit cube give finite unit vectors and proper rotations") {
        const double end = 1.0 - 0x1p-53;
        for (const double a : {0.0, end})
            for (const double b : {0.0, 0.125, 0.25, 0.5, end}) {
                CHECK(glm::length(direction({a, b})) == doctest::Approx(1.0));
                CHECK(std::isfinite(ball_point({b, b, a}).x));
                CHECK(glm::length(ball_point({b, b, a})) <= 1.0 + 1e-15);
                for (const double c : {0.0, 0.5, end}) {
                    const glm::dmat3 r = rotation({a, b, c});
                    CHECK(glm::determinant(r) == doctest::Approx(1.0));
                    CHECK(std::abs(glm::dot(r[0], r[1])) < 1e-15);
                }
            }
    }

    TEST_CASE("circle points agree with the library's sine and cosine to the last bits") {
        Random random(1);
        for (int i = 0; i < 10'000; ++i) {
            const double u = random.uniform();
            const glm::dvec2 p = circle_point(u);
            CHECK(std::abs(p.x - std::cos(2.0 * std::numbers::pi * u)) < 1e-15);
            CHECK(std::abs(p.y - std::sin(2.0 * std::numbers::pi * u)) < 1e-15);
        }
        CHECK(circle_point(0.25) == glm::dvec2(-0.0, 1.0));
    }

    TEST_CASE("a frame is orthonormal and right-handed for every axis") {
        Random random(2);
        for (int i = 0; i < 1'000; ++i) {
            glm::dvec3 axis = i == 0 ? glm::dvec3(0.0, 0.0, -1.0) : direction(random.point<2>());
            const auto [x, y] = orthonormal_frame(axis);
            CHECK(glm::length(glm::cross(x, y) - axis) < 1e-14);
            CHECK(std::abs(glm::dot(x, x) - 1.0) < 1e-14);
        }
    }

    TEST_CASE("directions, discs, balls and cosine-weighted directions have the moments of their densities") {
        const int n = 200'000;
        glm::dvec3 mean(0.0), squares(0.0), turned(0.0);
        double disc = 0.0, ball = 0.0, cosine = 0.0;
        const glm::dvec3 normal = glm::normalize(glm::dvec3(1.0, -2.0, 0.5));
        Random random(3);
        for (int i = 0; i < n; ++i) {
            const glm::dvec3 d = direction(random.point<2>());
            mean += d;
            squares += d * d;
            const glm::dvec2 p = disc_point(random.point<2>());
            disc += glm::dot(p, p);
            const glm::dvec3 b = ball_point(random.point<3>());
            ball += glm::dot(b, b);
            cosine += glm::dot(cosine_direction(normal, random.point<2>()), normal);
            const glm::dvec3 r = rotation(random.point<3>()) * normal;
            turned += r * r;
        }
        // Standard errors are at most 0.0013.
        for (int k = 0; k < 3; ++k) {
            CHECK(std::abs(mean[k] / n) < 0.006);
            CHECK(std::abs(squares[k] / n - 1.0 / 3.0) < 0.004);
            CHECK(std::abs(turned[k] / n - 1.0 / 3.0) < 0.004);
        }
        CHECK(std::abs(disc / n - 0.5) < 0.003);
        CHECK(std::abs(ball / n - 0.6) < 0.003);
        CHECK(std::abs(cosine / n - 2.0 / 3.0) < 0.003);
    }

    TEST_CASE("the angle of a uniform rotation has density (1 − cos θ)/π") {
        // Haar measure: E[trace] = E[1 + 2 cos θ] = 0 and E[trace²] = 1.
        double trace = 0.0, squares = 0.0;
        const int n = 200'000;
        Random random(4);
        for (int i = 0; i < n; ++i) {
            const glm::dmat3 r = rotation(random.point<3>());
            const double t = r[0][0] + r[1][1] + r[2][2];
            trace += t;
            squares += t * t;
        }
        CHECK(std::abs(trace / n) < 0.01);
        CHECK(std::abs(squares / n - 1.0) < 0.02);
    }

    TEST_CASE("a random camera keeps its lens and is valid") {
        Camera prototype;
        prototype.fov_y = 0.3;
        const Aabb positions{glm::dvec3(-1.0, 4.0, 7.0), glm::dvec3(2.0, 7.0, 10.0)};
        Random random(6);
        glm::dvec3 low = positions.max, high = positions.min;
        for (int i = 0; i < 100; ++i) {
            const Camera camera = random_camera(prototype, positions, random.point<6>());
            CHECK(validate(camera).has_value());
            CHECK(camera.fov_y == 0.3);
            low = glm::min(low, camera.position);
            high = glm::max(high, camera.position);
        }
        // Some of 100 are in each third of the box's extent: none would be by a chance of 1e-17.
        for (int k = 0; k < 3; ++k) {
            CHECK(low[k] >= positions.min[k]);
            CHECK(high[k] <= positions.max[k]);
            CHECK(low[k] < positions.min[k] + 1.0);
            CHECK(high[k] > positions.max[k] - 1.0);
        }
    }
}
