// SPDX-License-Identifier: MIT
// Philox, many counters at a time (no GLM here: see docs/architecture.md on vector kernels).
#pragma once
#include <cstddef>
#include <cstdint>

namespace crofton::sampling::kernels {

inline constexpr std::size_t kPhiloxBlocks = 8;

// Random::block of kPhiloxBlocks counters from `first` on: the upper half of a counter is `stream`, and the key `seed`.
// Two numbers a block.
void philox(std::uint64_t first, std::uint64_t stream, std::uint64_t seed, std::uint64_t* numbers);

}  // namespace crofton::sampling::kernels
