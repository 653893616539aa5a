// SPDX-License-Identifier: MIT
// Random numbers that are the same bits on every machine, for any number of threads.
#pragma once
#include <array>
#include <crofton/core/requirements.hpp>
#include <cstddef>
#include <cstdint>

namespace crofton::sampling {

// The counter-based generator Philox4x32-10 (Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as 1, 2, 3",
// 2011): 2^64 streams per seed, each of 2^65 values, independent of one another; integer arithmetic only.
class Random {
  public:
    explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : seed_(seed), stream_(stream) {}

    // 64 random bits.
    [[nodiscard]] std::uint64_t bits();
    // A multiple of 2^-53 in [0, 1).
    [[nodiscard]] double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
    [[nodiscard]] double uniform(double low, double high) { return low + (high - low) * uniform(); }
    template <std::size_t D>
    [[nodiscard]] std::array<double, D> point() {
        std::array<double, D> result;
        for (double& x : result) x = uniform();
        return result;
    }

    // The generator's block function: 128 random bits for a counter under a key.
    using Block = std::array<std::uint32_t, 4>;
    [[nodiscard]] static Block block(const Block& counter, const std::array<std::uint32_t, 2>& key);

  private:
    std::uint64_t seed_, stream_;
    std::uint64_t position_ = 0;
    std::uint64_t spare_ = 0;
    bool has_spare_ = false;
};

enum class Sequence : std::uint8_t {
    pseudo_random,  // independent points: errors have the usual binomial size
    quasi_random,   // evenly spread points: smaller errors, but no binomial estimate of them; vary the seed for one
};

// Points of the unit cube [0, 1)^D, D ≤ 8, by number, so that trial i is the same whoever computes it.
// Quasi-random: Sobol's sequence with the direction numbers of Joe and Kuo ("Constructing Sobol sequences with better
// two-dimensional projections", 2008), digitally shifted by the seed. Spend powers of two of them.
class UnitPoints {
  public:
    explicit UnitPoints(std::uint64_t seed, Sequence sequence = Sequence::pseudo_random)
        : seed_(seed), sequence_(sequence) {}

    template <std::size_t D>
    requires(D <= 8) [[nodiscard]] std::array<double, D> at(std::uint64_t index) const {
        std::array<double, D> result;
        fill(index, result.data(), D);
        return result;
    }

  private:
    void fill(std::uint64_t index, double* coordinates, std::size_t dimensions) const;

    std::uint64_t seed_;
    Sequence sequence_;
};

}  // namespace crofton::sampling
