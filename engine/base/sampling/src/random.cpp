// SPDX-License-Identifier: MIT
#include <crofton/sampling/sampling.hpp>

#include "random_kernels.hpp"

namespace crofton::sampling {
namespace {

constexpr std::size_t kMaxDimensions = 8;
using Directions = std::array<std::array<std::uint64_t, 64>, kMaxDimensions>;

// A primitive polynomial over GF(2) (its degree and inner coefficients) and the first odd numbers m_1, m_2, … .
struct SobolRow {
    unsigned degree, coefficients;
    std::array<std::uint64_t, 5> first;
};

constexpr Directions sobol_directions() {
    constexpr SobolRow rows[kMaxDimensions - 1] = {
        {1, 0, {1}},          {2, 1, {1, 3}},        {3, 1, {1, 3, 1}},       {3, 2, {1, 1, 1}},
        {4, 1, {1, 1, 3, 3}}, {4, 4, {1, 3, 5, 13}}, {5, 2, {1, 1, 5, 5, 17}}};
    Directions v{};
    for (std::size_t i = 0; i < 64; ++i) v[0][i] = std::uint64_t{1} << (63 - i);
    for (std::size_t d = 1; d < kMaxDimensions; ++d) {
        const SobolRow& row = rows[d - 1];
        for (std::size_t i = 0; i < 64; ++i) {
            if (i < row.degree) {
                v[d][i] = row.first[i] << (63 - i);
                continue;
            }
            v[d][i] = v[d][i - row.degree] ^ (v[d][i - row.degree] >> row.degree);
            for (unsigned k = 1; k < row.degree; ++k)
                if ((row.coefficients >> (row.degree - 1 - k)) & 1u) v[d][i] ^= v[d][i - k];
        }
    }
    return v;
}

constexpr Directions kDirections = sobol_directions();

}  // namespace

Random::Block Random::block(const Block& counter, const std::array<std::uint32_t, 2>& key) {
    Block c = counter;
    std::uint32_t k0 = key[0], k1 = key[1];
    for (int round = 0; round < kernels::kPhiloxRounds; ++round) {
        const std::uint64_t p0 = std::uint64_t{kernels::kPhiloxFactors[0]} * c[0];
        const std::uint64_t p1 = std::uint64_t{kernels::kPhiloxFactors[1]} * c[2];
        c = {static_cast<std::uint32_t>(p1 >> 32) ^ c[1] ^ k0, static_cast<std::uint32_t>(p1),
             static_cast<std::uint32_t>(p0 >> 32) ^ c[3] ^ k1, static_cast<std::uint32_t>(p0)};
        k0 += kernels::kPhiloxSteps[0];
        k1 += kernels::kPhiloxSteps[1];
    }
    return c;
}

std::uint64_t Random::bits() {
    if (has_spare_) {
        has_spare_ = false;
        return spare_;
    }
    const auto low = [](std::uint64_t x) { return static_cast<std::uint32_t>(x); };
    const auto high = [](std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32); };
    const Block b = block({low(position_), high(position_), low(stream_), high(stream_)}, {low(seed_), high(seed_)});
    ++position_;
    spare_ = b[2] | std::uint64_t{b[3]} << 32;
    has_spare_ = true;
    return b[0] | std::uint64_t{b[1]} << 32;
}

void Random::fill(std::span<std::uint64_t> numbers) {
    constexpr std::size_t kMany = 2 * kernels::kPhiloxBlocks;
    std::size_t at = 0;
    if (has_spare_ && !numbers.empty()) numbers[at++] = bits();
    for (; numbers.size() - at >= kMany; at += kMany, position_ += kernels::kPhiloxBlocks)
        kernels::philox(position_, stream_, seed_, numbers.data() + at);
    while (at < numbers.size()) numbers[at++] = bits();
}

void UnitPoints::fill(std::uint64_t index, double* coordinates, std::size_t dimensions) const {
    if (sequence_ == Sequence::pseudo_random) {
        Random random(seed_, index);
        for (std::size_t k = 0; k < dimensions; ++k) coordinates[k] = random.uniform();
        return;
    }
    Random shifts(seed_, ~std::uint64_t{0});
    for (std::size_t k = 0; k < dimensions; ++k) {
        std::uint64_t digits = shifts.bits();
        for (std::uint64_t left = index, bit = 0; left != 0; left >>= 1, ++bit)
            if (left & 1u) digits ^= kDirections[k][bit];
        coordinates[k] = static_cast<double>(digits >> 11) * 0x1p-53;
    }
}

}  // namespace crofton::sampling
