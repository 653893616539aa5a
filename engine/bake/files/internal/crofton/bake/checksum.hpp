// SPDX-License-Identifier: MIT
// Tells damaged bytes from sound ones, at the speed of memory.
#pragma once
#include <crofton/core/executor.hpp>
#include <cstddef>
#include <cstdint>
#include <span>

namespace crofton::bake {

// Any damage that is confined to one aligned 8-byte word changes the sum for certain, since every step is a bijection
// of the word and of the state. Other accidents go unseen with chance 2^-64. Not a defence against forgers. The same
// value with any executor.
[[nodiscard]] std::uint64_t checksum(std::span<const std::byte> bytes, Executor& executor = serial_executor());

}  // namespace crofton::bake
