// SPDX-License-Identifier: MIT
#include <gmpxx.h>

#include <doctest/doctest.h>
#include <cmath>
#include <crofton/geometry/dyadic.hpp>
#include <limits>
#include <random>

using crofton::Dyadic;

TEST_SUITE("geometry/dyadic") {
    TEST_CASE("zeros, denormals and the largest doubles keep their signs") {
        const double denormal = std::numeric_limits<double>::denorm_min(), largest = std::numeric_limits<double>::max();
        CHECK(Dyadic(0.0).sign() == 0);
        CHECK(Dyadic(-0.0).sign() == 0);
        CHECK((Dyadic(denormal) - Dyadic(denormal)).sign() == 0);
        CHECK((Dyadic(denormal) * Dyadic(denormal)).sign() == 1);
        CHECK((Dyadic(largest) * Dyadic(largest) - Dyadic(largest) * Dyadic(largest) -
               Dyadic(denormal) * Dyadic(denormal))
                  .sign() == -1);
        CHECK((Dyadic(largest) + Dyadic(-denormal) - Dyadic(largest)).sign() == -1);
    }

    TEST_CASE("signs of cancelling determinants agree with GMP's rationals") {
        std::mt19937_64 random(1);
        std::uniform_real_distribution<double> number(-1.0, 1.0);
        std::uniform_int_distribution<int> exponent(-600, 90);
        for (int trial = 0; trial < 20000; ++trial) {
            const auto draw = [&] {
                return std::ldexp(number(random), trial % 3 ? exponent(random) / 10 : exponent(random));
            };
            const double a = draw(), b = draw(), c = draw(), d = trial % 5 ? b * c / a : draw();
            const int sign = (Dyadic(a) * Dyadic(d) - Dyadic(b) * Dyadic(c)).sign();
            CHECK(sign == sgn(mpq_class(mpq_class(a) * d - mpq_class(b) * c)));
            const int cubic = (Dyadic(a) * Dyadic(a) * Dyadic(d) + Dyadic(b) * Dyadic(-a) * Dyadic(c)).sign();
            CHECK(cubic == sgn(mpq_class(mpq_class(a) * a * d - mpq_class(b) * a * c)));
        }
    }
}
