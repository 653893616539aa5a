// SPDX-License-Identifier: MIT
// Sums over the chains of a bake, and what chains a shard has.
#pragma once
#include <algorithm>
#include <crofton/radiosity/solver.hpp>

namespace crofton::radiosity {

constexpr std::uint64_t kMostRuns = std::uint64_t{1} << 32;

struct ChainRange {
    std::uint64_t begin = 0, end = 0;
};

[[nodiscard]] inline std::uint64_t chains_of(std::uint64_t runs) {
    return (runs + kRunsOfChain - 1) / kRunsOfChain;
}
// Returns the runs of chains [begin, end) in a bake of `runs`; the last chain may be shorter.
[[nodiscard]] inline std::uint64_t runs_within(ChainRange chains, std::uint64_t runs) {
    return (std::min)(chains.end * kRunsOfChain, runs) - (std::min)(chains.begin * kRunsOfChain, runs);
}
[[nodiscard]] ChainRange chains_of(const Shard& shard, std::uint64_t runs);
[[nodiscard]] bool has_chain(const Bake::Sums& sums, std::uint64_t chain);

// Adds what is not there yet, and joins neighbours that a node of the binary tree over all chains has below it.
void add(Bake::Sum sum, Bake::Sums& sums);

[[nodiscard]] Vector<std::byte> to_bytes(const Bake::Sums& sums);
// Errors: parse.
[[nodiscard]] Result<Bake::Sums> sums_from(std::span<const std::byte> bytes);

}  // namespace crofton::radiosity
