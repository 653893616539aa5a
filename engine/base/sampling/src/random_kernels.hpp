// SPDX-License-Identifier: MIT
// Philox, many counters at a time (no GLM here: see docs/architecture.md on vector kernels).
#pragma once
#include <cstddef>
#include <cstdint>

namespace crofton::sampling::kernels {

inline constexpr std::size_t kPhiloxBlocks = 8;
// Philox4x32: the factors of its products, and what its keys grow by from round to round.
inline constexpr std::uint32_t kPhiloxFactors[2] = {0xD2511F53u, 0xCD9E8D57u};
inline constexpr std::uint32_t kPhiloxSteps[2] = {0x9E3779B9u, 0xBB67AE85u};
inline constexpr int kPhiloxRounds = 10;

// Random::block of kPhiloxBlocks counters from `first` on: the upper half of a counter is `stream`, and the key `seed`.
// Two numbers a block.
void philox(std::uint64_t first, std::uint64_t stream, std::uint64_t seed, std::uint64_t* numbers);

}  // namespace crofton::sampling::kernels
