// SPDX-License-Identifier: MIT
// `crofton study lines --factors`: form factors by global lines, of Howell's standard pairs or of a scene.
#pragma once
#include <crofton/core/error.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "read_options.hpp"

namespace crofton::cli {

struct FactorsRun {
    std::vector<std::string> scenes;  // none: the standard pairs
    std::string map, json;
    std::uint64_t blocks = 2000, seed = 1;  // blocks of 1024 lines
    std::uint64_t patches = 1000;           // about as many a scene
    ReadOptions read = {};
};

// Pairs: F_12 beside its known value; kCheckFailed where one is off by more than kMaxZ errors. Scenes: one line each:
// mean crossings, what escapes, and the mutual information of the form factors in bits.
[[nodiscard]] Result<int> run_factors(const FactorsRun& run);

}  // namespace crofton::cli
