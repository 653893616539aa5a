// SPDX-License-Identifier: MIT
// The crowds of the culling benchmarks, each made once, and what the benchmarks report of a query.
#pragma once
#include <benchmark/benchmark.h>

#include <chrono>
#include <crofton/boxtree/box_tree.hpp>

#include "cull_crowd.hpp"

namespace crofton::bench {

// The scene that all benchmarks use: --scene=crowd, city, debris or, where files are read, shared. Takes the option out
// of the arguments; false, with a message, if there is no such scene.
[[nodiscard]] bool take_scene_option(int& argc, char** argv);
[[nodiscard]] const char* scene_in_use();

[[nodiscard]] const std::vector<Obb>& boxes_of(std::int64_t count);
[[nodiscard]] const boxtree::BoxTree& tree_of(std::int64_t count);

// Boxes numbered in the tree's order, as a renderer would lay its instances out.
[[nodiscard]] const std::vector<Obb>& boxes_in_tree_order(std::int64_t count);

// How many were seen, and nanoseconds a box of the benchmark's range(0).
void report(benchmark::State& state, std::size_t visible);

// Reads and writes more memory than caches hold: what a game does between two queries.
void leave_caches_cold();

// Of a benchmark with cold caches: making them cold takes far longer than what is timed.
inline constexpr int kColdIterations = 12;

// Times `ask` alone, as UseManualTime() wants it, with cold caches before each.
template <class Ask>
void time_cold(benchmark::State& state, const Ask& ask) {
    for (auto _ : state) {
        leave_caches_cold();
        const auto start = std::chrono::steady_clock::now();
        ask();
        state.SetIterationTime(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
}

}  // namespace crofton::bench
