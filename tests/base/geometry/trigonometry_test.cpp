// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/geometry/trigonometry.hpp>
#include <limits>
#include <numbers>
#include <random>

using namespace crofton;

namespace {

constexpr double kPi = std::numbers::pi, kEndless = std::numeric_limits<double>::infinity();
constexpr double kWithin = 6e-16;

// The C library's in the widest type, as the truth.
bool near(double value, long double truth, long double scale) {
    return std::fabs(static_cast<long double>(value) - truth) <= static_cast<long double>(kWithin) * scale;
}

}  // namespace

TEST_SUITE("geometry/trigonometry") {
    TEST_CASE("a number that is not finite has no sine, and an angle only along an axis") {
        for (const double bad : {std::nan(""), kEndless, -kEndless}) {
            CHECK(std::isnan(sine(bad)));
            CHECK(std::isnan(cosine(bad)));
            CHECK(std::isnan(tangent(bad)));
        }
        CHECK(std::isnan(arc_tangent(std::nan(""), 1.0)));
        CHECK(std::isnan(arc_tangent(1.0, std::nan(""))));
        CHECK(std::isnan(arc_tangent(kEndless, kEndless)));
        CHECK(arc_tangent(kEndless, 1.0) == 0.5 * kPi);
        CHECK(arc_tangent(-1.0, -kEndless) == -kPi);
        CHECK(std::isnan(arc_cosine(1.0 + 1e-15)));
        CHECK(std::isnan(arc_cosine(-2.0)));
    }

    TEST_CASE("the axes, with the signs of zeros") {
        CHECK(cosine_sine(0.0) == glm::dvec2(1.0, 0.0));
        CHECK(arc_tangent(0.0, 0.0) == 0.0);
        CHECK(std::signbit(arc_tangent(-0.0, 0.0)));
        CHECK(arc_tangent(0.0, -0.0) == kPi);
        CHECK(arc_tangent(-0.0, -1.0) == -kPi);
        CHECK(arc_tangent(2.0, 0.0) == 0.5 * kPi);
        CHECK(arc_tangent(1.0, 1.0) == 0.25 * kPi);
        CHECK(arc_cosine(1.0) == 0.0);
        CHECK(arc_cosine(-1.0) == kPi);
        CHECK(cube_root(0.0) == 0.0);
        for (int k = 1; k <= 200; ++k) CHECK(std::fabs(cube_root(1.0 * k * k * k) - k) <= kWithin * k);
    }

    TEST_CASE("within 6e-16 of the truth, everywhere") {
        std::mt19937_64 random(1);
        for (int i = 0; i < 300'000; ++i) {
            const double wide = std::ldexp(static_cast<double>(random() >> 11), -53);
            const double x = (2.0 * wide - 1.0) * (i % 3 == 0 ? 1e5 : i % 3 == 1 ? 10.0 : 0.75 * kPi);
            const long double truth_sine = std::sin(static_cast<long double>(x)),
                              truth_cosine = std::cos(static_cast<long double>(x));
            REQUIRE(near(sine(x), truth_sine, i % 3 == 2 && std::fabs(x) < 0.75 * kPi ? std::fabs(truth_sine) : 1.0L));
            REQUIRE(near(cosine(x), truth_cosine, 1.0L));
            const double half = (0.5 * kPi - 1e-4) * wide;
            REQUIRE(near(tangent(half), std::tan(static_cast<long double>(half)),
                         std::tan(static_cast<long double>(half))));
            const double y =
                std::ldexp(static_cast<double>(random() >> 11) - 0x1p52, static_cast<int>(random() % 60) - 80);
            const double a =
                std::ldexp(static_cast<double>(random() >> 11) - 0x1p52, static_cast<int>(random() % 60) - 80);
            const long double angle = std::atan2(static_cast<long double>(y), static_cast<long double>(a));
            REQUIRE(near(arc_tangent(y, a), angle, std::fabs(angle)));
            const double c = 2.0 * wide - 1.0;
            // MinGW's std::acos loses digits near 1.
            const long double wide_c = c, arc = std::atan2(std::sqrt((1.0L - wide_c) * (1.0L + wide_c)), wide_c);
            REQUIRE(near(arc_cosine(c), arc, arc));
            const double cube = std::ldexp(wide + 1e-3, static_cast<int>(random() % 2000) - 1000);
            REQUIRE(near(cube_root(cube), std::cbrt(static_cast<long double>(cube)),
                         std::cbrt(static_cast<long double>(cube))));
        }
    }
}
