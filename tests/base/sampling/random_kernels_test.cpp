// SPDX-License-Identifier: MIT
// A part of the generator that takes too long to reach from outside: counters beyond 2^32.
#include <doctest/doctest.h>
#include <hwy/highway.h>
#include <array>
#include <crofton/sampling/sampling.hpp>
#include <random_kernels.hpp>

using namespace crofton::sampling;

TEST_SUITE("sampling/random kernels") {
    TEST_CASE("blocks side by side are those of the generator for any counter, on every instruction set") {
        const auto halves = [](std::uint64_t x) {
            return std::array{static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(x >> 32)};
        };
        for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
            hwy::SetSupportedTargetsForTest(rest & -rest);
            Random random(4);
            for (int trial = 0; trial < 200; ++trial) {
                const std::uint64_t stream = random.bits(), seed = random.bits();
                // At the borders of a half, of the whole, and anywhere.
                const std::uint64_t first = trial == 0 ? 0xfffffffcull : trial == 1 ? ~3ull : random.bits();
                std::array<std::uint64_t, 2 * kernels::kPhiloxBlocks> numbers;
                kernels::philox(first, stream, seed, numbers.data());
                for (std::uint64_t i = 0; i < kernels::kPhiloxBlocks; ++i) {
                    const auto counter = halves(first + i), line = halves(stream);
                    const Random::Block block = Random::block({counter[0], counter[1], line[0], line[1]}, halves(seed));
                    REQUIRE(numbers[2 * i] == (block[0] | std::uint64_t{block[1]} << 32));
                    REQUIRE(numbers[2 * i + 1] == (block[2] | std::uint64_t{block[3]} << 32));
                }
            }
        }
        hwy::SetSupportedTargetsForTest(0);
    }
}
