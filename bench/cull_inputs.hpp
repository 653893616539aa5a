// SPDX-License-Identifier: MIT
// The crowds of the culling benchmarks, each made once, and what the benchmarks report of a query.
#pragma once
#include <benchmark/benchmark.h>

#include <crofton/boxtree/box_tree.hpp>

#include "cull_crowd.hpp"

namespace crofton::bench {

[[nodiscard]] const std::vector<Obb>& boxes_of(std::int64_t count);
[[nodiscard]] const boxtree::BoxTree& tree_of(std::int64_t count);

// Boxes numbered in the tree's order, as a renderer would lay its instances out.
[[nodiscard]] const std::vector<Obb>& boxes_in_tree_order(std::int64_t count);

// How many were seen, and nanoseconds a box of the benchmark's range(0).
void report(benchmark::State& state, std::size_t visible);

}  // namespace crofton::bench
