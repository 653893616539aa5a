// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <hwy/highway.h>
#include <crofton/sampling/sampling.hpp>
#include <set>
#include <vector>

using namespace crofton::sampling;

TEST_SUITE("sampling/random") {
    TEST_CASE("the generator gives the known answers of Philox4x32-10") {
        // Random123's published known-answer vectors: zeros, ones, digits of π.
        CHECK(Random::block({0, 0, 0, 0}, {0, 0}) == Random::Block{0x6627e8d5u, 0xe169c58du, 0xbc57ac4cu, 0x9b00dbd8u});
        const std::uint32_t f = 0xffffffffu;
        CHECK(Random::block({f, f, f, f}, {f, f}) == Random::Block{0x408f276du, 0x41c83b0eu, 0xa20bc7c6u, 0x6d5451fdu});
        CHECK(Random::block({0x243f6a88u, 0x85a308d3u, 0x13198a2eu, 0x03707344u}, {0xa4093822u, 0x299f31d0u}) ==
              Random::Block{0xd16cfe09u, 0x94fdccebu, 0x5001e420u, 0x24126ea1u});
    }

    TEST_CASE("seeds and streams give different numbers, the same ones every time") {
        std::set<std::uint64_t> seen;
        for (std::uint64_t seed : {0ull, 1ull, ~0ull})
            for (std::uint64_t stream : {0ull, 1ull, ~0ull}) {
                Random a(seed, stream), b(seed, stream);
                for (int i = 0; i < 100; ++i) {
                    const std::uint64_t value = a.bits();
                    CHECK(value == b.bits());
                    seen.insert(value);
                }
            }
        CHECK(seen.size() == 900);
    }

    TEST_CASE("repetitions under different seeds share no seed, and those of seed 1 count from 1") {
        for (const std::uint64_t count : {1u, 12u, 128u}) {
            std::set<std::uint64_t> seen;
            for (std::uint64_t seed = 0; seed < 20; ++seed)
                for (std::uint64_t i = 0; i < count; ++i) seen.insert(seed_of_repetition(seed, i, count));
            CHECK(seen.size() == 20 * count);
            CHECK(seed_of_repetition(1, count - 1, count) == count);
        }
    }

    TEST_CASE("many numbers at once are those one by one, on every instruction set") {
        for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
            hwy::SetSupportedTargetsForTest(rest & -rest);
            for (const std::uint64_t seed : {0ull, 1ull, ~0ull, 0x123456789abcdefull})
                for (const std::size_t first : {0u, 1u, 2u})
                    for (const std::size_t count : {0u, 1u, 2u, 15u, 16u, 17u, 63u, 64u, 200u}) {
                        Random many(seed, ~seed), each(seed, ~seed);
                        for (std::size_t i = 0; i < first; ++i) CHECK(many.bits() == each.bits());
                        std::vector<std::uint64_t> numbers(count + 1, 7);
                        many.fill({numbers.data(), count});
                        for (std::size_t i = 0; i < count; ++i) REQUIRE(numbers[i] == each.bits());
                        CHECK(numbers[count] == 7);
                        CHECK(many.bits() == each.bits());
                    }
        }
        hwy::SetSupportedTargetsForTest(0);
    }

    TEST_CASE("uniform numbers lie between 0 and below 1 and have mean 1/2 and variance 1/12") {
        Random random(5);
        double sum = 0.0, squares = 0.0;
        const int n = 200'000;
        for (int i = 0; i < n; ++i) {
            const double x = random.uniform();
            REQUIRE(x >= 0.0);
            REQUIRE(x < 1.0);
            sum += x;
            squares += x * x;
        }
        CHECK(sum / n == doctest::Approx(0.5).epsilon(0.005));
        CHECK(squares / n - 0.25 == doctest::Approx(1.0 / 12.0).epsilon(0.02));
    }

    TEST_CASE("numbered points do not depend on the order of the calls") {
        for (const Sequence sequence : {Sequence::pseudo_random, Sequence::quasi_random}) {
            const UnitPoints points(9, sequence);
            const auto late = points.at<6>(1'000'000);
            (void)points.at<6>(0);
            CHECK(points.at<6>(1'000'000) == late);
            CHECK(UnitPoints(10, sequence).at<6>(1'000'000) != late);
        }
    }

    TEST_CASE("quasi-random points fill the cube far more evenly than chance") {
        // 4,096 points, 16 × 16 cells of the plane of every pair of coordinates: 16 expected each.
        const UnitPoints points(3, Sequence::quasi_random);
        for (std::size_t a = 0; a < 6; ++a)
            for (std::size_t b = a + 1; b < 6; ++b) {
                int cells[256] = {};
                for (std::uint64_t i = 0; i < 4096; ++i) {
                    const auto p = points.at<6>(i);
                    ++cells[static_cast<int>(p[a] * 16.0) * 16 + static_cast<int>(p[b] * 16.0)];
                }
                double chi_square = 0.0;  // chance: 255 ± 23
                for (const int count : cells) chi_square += (count - 16.0) * (count - 16.0) / 16.0;
                CHECK(chi_square < 160.0);
            }
    }

    TEST_CASE("every elementary interval of a coordinate holds one of the first 2^k quasi-random points") {
        const UnitPoints points(4, Sequence::quasi_random);
        for (std::size_t k = 0; k < 8; ++k) {
            std::set<int> cells;
            for (std::uint64_t i = 0; i < 1024; ++i) cells.insert(static_cast<int>(points.at<8>(i)[k] * 1024.0));
            CHECK(cells.size() == 1024);
        }
    }
}
