// SPDX-License-Identifier: MIT
// States of pairs as few bits: an adaptive binary arithmetic coder that looks at the neighbours.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/pvs/pvs.hpp>
#include <cstddef>
#include <cstdint>
#include <span>

namespace crofton::pvs {

// By cell and object, one PairState each; cells in a grid of `counts`, x first (a row of cells that are no grid).
struct PairStates {
    glm::uvec3 counts{1};
    std::uint32_t objects = 0;
    Vector<std::uint8_t> states;
};

[[nodiscard]] Vector<std::byte> encode(const PairStates& pairs);
// Fills pairs.states by the other members. Any bytes decode to something: a checksum says whether they are right.
void decode(std::span<const std::byte> bytes, PairStates& pairs);
// The most pairs that so many bytes can stand for: no decision takes less than 1/2000 of a bit.
[[nodiscard]] std::uint64_t most_pairs(std::size_t bytes);

}  // namespace crofton::pvs
