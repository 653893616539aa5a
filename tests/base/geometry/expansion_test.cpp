// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <gmpxx.h>

#include <cmath>
#include <crofton/geometry/expansion.hpp>
#include <random>

using namespace crofton;

TEST_SUITE("geometry/expansion") {
    TEST_CASE("a sum that cancels to zero has sign zero and no terms") {
        const auto zero = exact_product(0.1, 3.0) - exact_product(3.0, 0.1);
        CHECK(zero.sign() == 0);
        CHECK(zero.count == 0);
        CHECK((zero * 7.0).sign() == 0);
        CHECK((zero + exact(1.0)).sign() == 1);
    }

    TEST_CASE("sees a difference far below double precision") {
        // (2^30 + 2^-30)^2 − 2^60 − 2 = 2^-60
        const auto x = exact_sum(0x1p30, 0x1p-30);
        const auto rest = x * x - exact_sum(0x1p60, 2.0);
        CHECK(rest.sign() == 1);
        CHECK(rest.estimate() == 0x1p-60);
    }

    TEST_CASE("products of halves and fused ones have the same bits") {
        std::mt19937_64 random(8);
        std::uniform_real_distribution<double> number(-1.0, 1.0);
        for (int trial = 0; trial < 200000; ++trial) {
            const double a = std::ldexp(number(random), static_cast<int>(random() % 900) - 450);
            const double b = std::ldexp(number(random), static_cast<int>(random() % 900) - 450);
            const auto halves = crofton::detail::two_product_of_halves(a, b),
                       whole = crofton::detail::two_product(a, b);
            REQUIRE(halves.high == whole.high);
            REQUIRE(halves.low == whole.low);
        }
    }

    TEST_CASE("agrees with integers of any length on random sums of products") {
        std::mt19937_64 random(7);
        std::uniform_int_distribution<std::int64_t> number(-(1ll << 53), 1ll << 53);
        for (int trial = 0; trial < 20000; ++trial) {
            const std::int64_t a = number(random), b = number(random), c = number(random), d = number(random) % 1024;
            // All four are doubles without rounding.
            const mpz_class truth = mpz_class(double(a)) * double(b) - mpz_class(double(c)) * double(d) * 512;
            const auto e = exact_product(double(a), double(b)) - exact_product(double(c), double(d)) * 512.0;
            CHECK(e.sign() == sgn(truth));
            mpz_class sum = 0;
            for (std::size_t i = 0; i < e.count; ++i) sum += mpz_class(e.terms[i]);
            CHECK(static_cast<bool>(sum == truth));
        }
    }
}
