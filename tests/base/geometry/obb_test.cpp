// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/dyadic.hpp>
#include <error_of.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <random>

using namespace crofton;

namespace {

Obb random_box(std::mt19937& random, double center_size) {
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    Obb box;
    box.center = glm::dvec3(unit(random), unit(random), unit(random)) * center_size;
    box.axes =
        glm::mat3(glm::rotate(glm::mat4(1.0f), 3.0f * unit(random), glm::vec3(unit(random), unit(random), 1.1f)));
    box.half_extents = glm::abs(glm::vec3(unit(random), unit(random), unit(random)));
    return box;
}

}  // namespace

TEST_SUITE("geometry/obb") {
    TEST_CASE("invalid boxes are refused by name") {
        const float nan = std::numeric_limits<float>::quiet_NaN();
        Obb box;
        CHECK(validate(box).has_value());
        box.half_extents.y = nan;
        CHECK(error_of(validate(box, 5)).item == 5);
        CHECK(error_of(validate(box, 5)).code == ErrorCode::non_finite);
        box.half_extents.y = -1.0f;
        CHECK(error_of(validate(box)).code == ErrorCode::invalid_argument);
        box = Obb{};
        box.center.x = std::numeric_limits<double>::infinity();
        CHECK(error_of(validate(box)).code == ErrorCode::non_finite);
        for (int k = 0; k < 3; ++k)
            for (const double sign : {-1.0, 1.0}) {
                box = Obb{};
                box.center[k] = sign * 1e30;
                CHECK(validate(box).has_value());
                box.center[k] = sign * 1.0000001e30;
                CHECK(error_of(validate(box)).code == ErrorCode::out_of_range);
            }
        box = Obb{};
        box.axes[0] = glm::vec3(1.0f, 0.1f, 0.0f);
        CHECK(error_of(validate(box)).code == ErrorCode::invalid_argument);
    }

    TEST_CASE("containment is exact at the boundary, to the last bit") {
        Obb box;
        box.center = {1e7, 0.0, 0.0};
        box.half_extents = {1.0f, 2.0f, 0.0f};
        CHECK(contains(box, {1e7 + 1.0, 2.0, 0.0}));
        CHECK_FALSE(contains(box, {std::nextafter(1e7 + 1.0, 2e7), 0.0, 0.0}));
        CHECK_FALSE(contains(box, {1e7, std::nextafter(2.0, 3.0), 0.0}));
        CHECK_FALSE(contains(box, {1e7, 0.0, 5e-324}));
    }

    TEST_CASE("corners and support points lie within rounding of the exact box, and its AABB holds them all") {
        std::mt19937 random(1);
        for (int trial = 0; trial < 1000; ++trial) {
            const Obb box = random_box(random, 100.0);
            Obb grown = box;
            grown.half_extents += glm::vec3(1e-5f);
            const Aabb aabb = aabb_of(box);
            for (const glm::dvec3& corner : corners(box)) {
                CHECK(contains(grown, corner));
                CHECK(glm::all(glm::lessThanEqual(aabb.min, corner)));
                CHECK(glm::all(glm::lessThanEqual(corner, aabb.max)));
            }
            const glm::dvec3 direction(0.3, -0.5, 0.8);
            double best = -1e300;
            for (const glm::dvec3& corner : corners(box)) best = std::max(best, glm::dot(corner, direction));
            CHECK(glm::dot(support_point(box, direction), direction) == doctest::Approx(best));
        }
    }

    TEST_CASE("the AABB of a box holds it exactly, also where a side lies near zero and rounds to almost nothing") {
        std::mt19937 random(3);
        std::uniform_real_distribution<double> number(-1.0, 1.0);
        for (int trial = 0; trial < 2000; ++trial) {
            Obb box = random_box(random, 0.0);
            for (int i = 0; i < 3; ++i) {
                for (int k = 0; k < 3; ++k)
                    box.center[i] += std::abs(double(box.axes[k][i]) * double(box.half_extents[k]));
                box.center[i] *= (trial % 2 ? -1.0 : 1.0) + 1e-15 * number(random);
            }
            const Aabb aabb = aabb_of(box);
            for (int i = 0; i < 3; ++i) {
                Dyadic reach;
                for (int k = 0; k < 3; ++k)
                    reach = reach + abs(Dyadic(double(box.axes[k][i])) * Dyadic(double(box.half_extents[k])));
                const Dyadic center(box.center[i]);
                REQUIRE((center - reach - Dyadic(aabb.min[i])).sign() >= 0);
                REQUIRE((center + reach - Dyadic(aabb.max[i])).sign() <= 0);
            }
        }
    }

    TEST_CASE("a box around an AABB contains its corners, also where the extents do not fit a float") {
        std::mt19937 random(2);
        std::uniform_real_distribution<double> number(-1e6, 1e6);
        for (int trial = 0; trial < 1000; ++trial) {
            Aabb aabb;
            for (int i = 0; i < 3; ++i) aabb.include(glm::dvec3(number(random), number(random), number(random)));
            const Obb box = obb_of(aabb);
            CHECK(contains(box, aabb.min));
            CHECK(contains(box, aabb.max));
        }
    }
}
