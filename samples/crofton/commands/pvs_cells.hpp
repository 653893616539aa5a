// SPDX-License-Identifier: MIT
// Cells and shards as they are typed.
#pragma once
#include <crofton/pvs/pvs.hpp>
#include <span>
#include <string>

#include "assets/read_limits.hpp"

namespace crofton::cli {

// "NXxNYxNZ" over `eyes`, or a file with a box a line: six numbers, min and max; lines that begin with # are comments.
// Errors name the file and the line.
[[nodiscard]] Result<pvs::Cells> cells_from(const std::string& text, const Aabb& eyes,
                                            const assets::ReadLimits& limits);
// "i/n" with 0 ≤ i < n; "": all.
[[nodiscard]] Result<pvs::Shard> shard_from(const std::string& text);
// "x,y,z…": as many numbers as `numbers` has room for.
[[nodiscard]] Result<void> read_numbers(const char* option, const std::string& text, std::span<double> numbers);

}  // namespace crofton::cli
