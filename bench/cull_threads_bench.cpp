// SPDX-License-Identifier: MIT
// Two threads beside one.
#include <benchmark/benchmark.h>

#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/cull/bound_set.hpp>

#include "cull_inputs.hpp"

namespace {

using namespace crofton;
using bench::boxes_of, bench::tree_of;

// Two threads beside one, the same query.
void threads(benchmark::State& state) {
    ThreadPool pool(static_cast<unsigned>(state.range(1)));
    const auto& boxes = boxes_of(state.range(0));
    const cull::View view = bench::view_of_share(boxes, 0.2);
    cull::BoxSet set;
    set.assign(boxes);
    cull::VerdictBits verdicts;
    for (auto _ : state) {
        cull::find_visible(set, boxes, view, verdicts, cull::CullMode::exact, pool);
        benchmark::DoNotOptimize(verdicts.visible.data());
    }
}
BENCHMARK(threads)->Args({1000000, 1})->Args({1000000, 2})->UseRealTime();

void tree_threads(benchmark::State& state) {
    ThreadPool pool(static_cast<unsigned>(state.range(1)));
    const boxtree::BoxTree& tree = tree_of(state.range(0));
    const cull::View view = bench::view_of_share(boxes_of(state.range(0)), 0.2);
    cull::VisibleSet visible;
    for (auto _ : state) {
        cull::find_visible(tree, view, visible, {cull::CullMode::exact, cull::ResultOrder::tree}, pool);
        benchmark::DoNotOptimize(visible.ids().data());
    }
}
BENCHMARK(tree_threads)->Args({1000000, 1})->Args({1000000, 2})->UseRealTime();

void build_threads(benchmark::State& state) {
    ThreadPool pool(static_cast<unsigned>(state.range(1)));
    const auto& boxes = boxes_of(state.range(0));
    for (auto _ : state) benchmark::DoNotOptimize(boxtree::BoxTree::build(boxes, {}, pool)->item_count());
}
BENCHMARK(build_threads)->Args({1000000, 1})->Args({1000000, 2})->UseRealTime()->Unit(benchmark::kMillisecond);

// What two cores can give at best: each asks the same query for itself, and waits for nobody.
void threads_apart(benchmark::State& state) {
    const auto& boxes = boxes_of(state.range(0));
    const cull::View view = bench::view_of_share(boxes, 0.2);
    static const cull::BoxSet& set = [&]() -> const cull::BoxSet& {
        static cull::BoxSet made;
        made.assign(boxes);
        return made;
    }();
    cull::VerdictBits verdicts;
    for (auto _ : state) {
        cull::find_visible(set, boxes, view, verdicts, cull::CullMode::exact);
        benchmark::DoNotOptimize(verdicts.visible.data());
    }
}
BENCHMARK(threads_apart)->Arg(1000000)->Threads(1)->Threads(2)->UseRealTime();

void tree_threads_apart(benchmark::State& state) {
    const boxtree::BoxTree& tree = tree_of(state.range(0));
    const cull::View view = bench::view_of_share(boxes_of(state.range(0)), 0.2);
    cull::VisibleSet visible;
    for (auto _ : state) {
        cull::find_visible(tree, view, visible, {cull::CullMode::exact, cull::ResultOrder::tree});
        benchmark::DoNotOptimize(visible.ids().data());
    }
}
BENCHMARK(tree_threads_apart)->Arg(1000000)->Threads(1)->Threads(2)->UseRealTime();

}  // namespace
