// SPDX-License-Identifier: MIT
// One view of a tree: what a query costs, what its order of ids costs, and building.
#include <benchmark/benchmark.h>

#include <crofton/boxtree/box_tree.hpp>
#include <crofton/cull/cull.hpp>
#include <map>
#include <span>
#include <utility>

#include "cull_inputs.hpp"

namespace {

using namespace crofton;
using bench::boxes_in_tree_order, bench::boxes_of, bench::report, bench::tree_of;

void tree_cull(benchmark::State& state, cull::CullMode mode, cull::ResultOrder order, double share) {
    const boxtree::BoxTree& tree = tree_of(state.range(0));
    const cull::View view = bench::view_of_share(boxes_of(state.range(0)), share);
    cull::VisibleSet visible;
    for (auto _ : state) {
        cull::find_visible(tree, view, visible, {mode, order});
        benchmark::DoNotOptimize(visible.ids().data());
    }
    report(state, visible.size());
    state.counters["boxes_tested"] = static_cast<double>(visible.statistics().boxes_tested);
    state.counters["nodes_tested"] = static_cast<double>(visible.statistics().nodes_tested);
    state.counters["exact_tests"] = static_cast<double>(visible.statistics().exact_tests);
    state.counters["straddling"] = static_cast<double>(visible.statistics().straddling);
}
BENCHMARK_CAPTURE(tree_cull, conservative, cull::CullMode::conservative, cull::ResultOrder::tree, 0.2)
    ->RangeMultiplier(10)
    ->Range(10000, 1000000);
BENCHMARK_CAPTURE(tree_cull, exact, cull::CullMode::exact, cull::ResultOrder::tree, 0.2)
    ->RangeMultiplier(10)
    ->Range(10000, 1000000);
BENCHMARK_CAPTURE(tree_cull, exact_ascending, cull::CullMode::exact, cull::ResultOrder::ascending, 0.2)->Arg(1000000);
BENCHMARK_CAPTURE(tree_cull, exact_1_percent, cull::CullMode::exact, cull::ResultOrder::tree, 0.01)->Arg(1000000);

void tree_cull_cold(benchmark::State& state, cull::ResultOrder order, double share) {
    const boxtree::BoxTree& tree = tree_of(state.range(0));
    const cull::View view = bench::view_of_share(boxes_of(state.range(0)), share);
    cull::VisibleSet visible;
    bench::time_cold(state, [&] { cull::find_visible(tree, view, visible, {cull::CullMode::exact, order}); });
    report(state, visible.size());
}
BENCHMARK_CAPTURE(tree_cull_cold, exact, cull::ResultOrder::tree, 0.2)
    ->Arg(10000)
    ->Arg(1000000)
    ->UseManualTime()
    ->Iterations(bench::kColdIterations);
BENCHMARK_CAPTURE(tree_cull_cold, exact_ascending, cull::ResultOrder::ascending, 0.2)
    ->Arg(1000000)
    ->UseManualTime()
    ->Iterations(bench::kColdIterations);
BENCHMARK_CAPTURE(tree_cull_cold, exact_1_percent, cull::ResultOrder::tree, 0.01)
    ->Arg(1000000)
    ->UseManualTime()
    ->Iterations(bench::kColdIterations);

void tree_cull_numbered(benchmark::State& state, cull::ResultOrder order) {
    const auto& boxes = boxes_in_tree_order(state.range(0));
    const boxtree::BoxTree tree = *boxtree::BoxTree::build(boxes);
    const cull::View view = bench::view_of_share(boxes, 0.2);
    cull::VisibleSet visible;
    for (auto _ : state) {
        cull::find_visible(tree, view, visible, {cull::CullMode::exact, order});
        benchmark::DoNotOptimize(visible.ids().data());
    }
    report(state, visible.size());
}
BENCHMARK_CAPTURE(tree_cull_numbered, in_tree_order, cull::ResultOrder::tree)->Arg(1000000);
BENCHMARK_CAPTURE(tree_cull_numbered, ascending, cull::ResultOrder::ascending)->Arg(1000000);

// 300 cameras on a way through the crowd, each seeing about 1 % of it.
void flight(benchmark::State& state, cull::CullMode mode) {
    const boxtree::BoxTree& tree = tree_of(state.range(0));
    const double side = std::cbrt(static_cast<double>(state.range(0)));
    std::vector<cull::View> views;
    for (int f = 0; f < 300; ++f) {
        Camera camera;
        const double angle = 0.02 * f;
        camera.position = side * glm::dvec3(0.5 + 0.3 * std::cos(angle), 0.5 + 0.1 * std::sin(3.0 * angle),
                                            0.5 + 0.3 * std::sin(angle));
        camera.forward = {-std::sin(angle), 0.1, std::cos(angle)};
        camera.aspect = 1.0;
        camera.far_distance = 0.31 * side;
        views.push_back({*frustum_of(camera)});
    }
    cull::VisibleSet visible;
    std::size_t frame = 0, seen = 0;
    for (auto _ : state) {
        cull::find_visible(tree, views[frame++ % views.size()], visible, {mode, cull::ResultOrder::tree});
        seen += visible.size();
    }
    report(state, frame ? seen / frame : 0);
}
BENCHMARK_CAPTURE(flight, conservative, cull::CullMode::conservative)->Arg(1000000);
BENCHMARK_CAPTURE(flight, exact, cull::CullMode::exact)->Arg(1000000);

void tree_build(benchmark::State& state) {
    const auto& boxes = boxes_of(state.range(0));
    for (auto _ : state) benchmark::DoNotOptimize(boxtree::BoxTree::build(boxes)->item_count());
    report(state, 0);
}
// Once, in memory that is new to the process: run it alone (--benchmark_filter=tree_build/first).
BENCHMARK(tree_build)->Name("tree_build/first")->Arg(1000000)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK(tree_build)->Arg(10000)->Arg(100000)->Arg(1000000)->Unit(benchmark::kMillisecond);

// One box after another into a tree of so many; its arrays have grown before.
void tree_insert(benchmark::State& state) {
    const auto& boxes = boxes_of(state.range(0));
    boxtree::BoxTree tree = *boxtree::BoxTree::build(boxes);
    std::size_t next = 0;
    const auto insert = [&] {
        next = (next + 7919) % boxes.size();
        benchmark::DoNotOptimize(tree.insert(boxes[next]).has_value());
    };
    for (int i = 0; i < 1000; ++i) insert();
    for (auto _ : state) insert();
}
// A tree a tenth of which was inserted one by one, beside one that was built of all.
enum class Grown { built, inserted, refitted, rebuilt };

const boxtree::BoxTree& grown_tree(std::int64_t count, Grown grown) {
    if (grown == Grown::built) return tree_of(count);
    static std::map<std::pair<std::int64_t, Grown>, boxtree::BoxTree> trees;
    const auto found = trees.find({count, grown});
    if (found != trees.end()) return found->second;
    const std::span<const Obb> boxes = boxes_of(count);
    const std::size_t before = boxes.size() - boxes.size() / 10;
    boxtree::BoxTree tree = *boxtree::BoxTree::build(boxes.first(before));
    for (const Obb& box : boxes.subspan(before)) benchmark::DoNotOptimize(tree.insert(box).has_value());
    if (grown != Grown::inserted) tree.refit();
    while (grown == Grown::rebuilt && !tree.rebuild_step(1'000'000)) tree.refit();
    return trees.emplace(std::pair(count, grown), std::move(tree)).first->second;
}

void tree_cull_grown(benchmark::State& state, Grown grown, double share) {
    const boxtree::BoxTree& tree = grown_tree(state.range(0), grown);
    const cull::View view = bench::view_of_share(boxes_of(state.range(0)), share);
    cull::VisibleSet visible;
    for (auto _ : state) {
        cull::find_visible(tree, view, visible, {cull::CullMode::exact, cull::ResultOrder::tree});
        benchmark::DoNotOptimize(visible.ids().data());
    }
    report(state, visible.size());
    state.counters["boxes_tested"] = static_cast<double>(visible.statistics().boxes_tested);
    state.counters["nodes_tested"] = static_cast<double>(visible.statistics().nodes_tested);
}
BENCHMARK_CAPTURE(tree_cull_grown, built, Grown::built, 0.2)->Arg(1000000);
BENCHMARK_CAPTURE(tree_cull_grown, inserted, Grown::inserted, 0.2)->Arg(1000000);
BENCHMARK_CAPTURE(tree_cull_grown, refitted, Grown::refitted, 0.2)->Arg(1000000);
BENCHMARK_CAPTURE(tree_cull_grown, rebuilt, Grown::rebuilt, 0.2)->Arg(1000000);
BENCHMARK_CAPTURE(tree_cull_grown, built_1_percent, Grown::built, 0.01)->Arg(1000000);
BENCHMARK_CAPTURE(tree_cull_grown, inserted_1_percent, Grown::inserted, 0.01)->Arg(1000000);
BENCHMARK_CAPTURE(tree_cull_grown, refitted_1_percent, Grown::refitted, 0.01)->Arg(1000000);
BENCHMARK_CAPTURE(tree_cull_grown, rebuilt_1_percent, Grown::rebuilt, 0.01)->Arg(1000000);

BENCHMARK(tree_insert)->Arg(1000000)->Iterations(20000)->Unit(benchmark::kMicrosecond);

}  // namespace
