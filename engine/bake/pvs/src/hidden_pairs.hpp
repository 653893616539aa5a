// SPDX-License-Identifier: MIT
// Proves, group by group, which pairs of a cell and an object are hidden behind opaque bodies.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/pvs/pvs.hpp>

#include "bake_data.hpp"
#include "shaft.hpp"

namespace crofton::pvs {

// Clears in `open` (by cell, by object; as Found::seen) the bits of pairs that are proved hidden. Those that lines have
// seen stay. The same bits for any executor.
void prove_hidden(const Bake::State& bake, std::span<const Blocker> bodies, const ProofOptions& options,
                  Executor& executor, Vector<std::uint64_t>& open);

}  // namespace crofton::pvs
