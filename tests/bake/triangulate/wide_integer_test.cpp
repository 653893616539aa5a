// SPDX-License-Identifier: MIT
// Integers of any size against 128 bits of the compiler's and against GMP.
#include <doctest/doctest.h>
#include <gmpxx.h>
#include <random>

#include "numbers/wide_integer.hpp"

using namespace crofton::triangulate;

TEST_SUITE("triangulate/wide_integer") {
    TEST_CASE(
        "sums, differences, products, shifts, roots and comparisons are those of GMP, zero and small ones included") {
        std::mt19937_64 random(1);
        const auto number = [&] { return random() % 3 ? random() >> random() % 64 : random() % 4; };
        const auto wide = [](std::uint64_t value) { return mpz_class(static_cast<unsigned long>(value)); };
        const auto check = [](const WideInteger& x, const mpz_class& expected) {
            // As told by its own comparison with what is put together bit by bit.
            WideInteger same, one(1);
            for (std::size_t bit = 0; bit < mpz_sizeinbase(expected.get_mpz_t(), 2); ++bit)
                if (mpz_tstbit(expected.get_mpz_t(), bit)) same += one << bit;
            CHECK(x.compare(same) == 0);
            CHECK(x.is_zero() == (expected == 0));
            CHECK(x.bit_count() == (expected == 0 ? 0 : mpz_sizeinbase(expected.get_mpz_t(), 2)));
        };
        for (int trial = 0; trial < 2000; ++trial) {
            const std::uint64_t a = number(), b = number();
            const std::size_t shift = random() % 200;
            const WideInteger x(a), y(b);
            check(x, wide(a));
            CHECK(x.compare(y) == (a < b ? -1 : a > b ? 1 : 0));
            CHECK((x * y).compare(y << shift) == cmp(wide(a) * wide(b), wide(b) << shift));
            check(x << shift, wide(a) << shift);
            check(x * y, wide(a) * wide(b));
            WideInteger sum = x << shift;
            sum += y;
            check(sum, (wide(a) << shift) + wide(b));
            sum -= x;
            if (shift > 0 || b >= a) check(sum, (wide(a) << shift) + wide(b) - wide(a));
            bool exact = false;
            const WideInteger root = WideInteger::square_root(x << shift, exact);
            const mpz_class square = wide(a) << shift;
            check(root, sqrt(square));
            CHECK(exact == (mpz_perfect_square_p(square.get_mpz_t()) != 0));
        }
    }
}
