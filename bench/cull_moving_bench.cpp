// SPDX-License-Identifier: MIT
// Trees whose boxes move: an update and a query, and what long motion leaves behind.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <cstdlib>
#include <map>
#include <random>
#include <vector>

#include "cull_inputs.hpp"

namespace {

using namespace crofton;
using bench::boxes_in_tree_order, bench::boxes_of, bench::report, bench::tree_of;

// After ten thousand frames of random motion, a hundredth of the boxes a frame by up to a tenth of the spacing, with
// bounded rebuilding in the background: a query beside one in a tree built afresh from the same boxes.
void aged_cull(benchmark::State& state, bool fresh) {
    static std::map<std::int64_t, std::pair<std::vector<Obb>, boxtree::BoxTree>> aged;
    const std::int64_t count = state.range(0);
    if (!aged.contains(count)) {
        std::vector<Obb> boxes = boxes_of(count);
        boxtree::BoxTree tree = *boxtree::BoxTree::build(boxes);
        std::mt19937 random(1);
        std::uniform_real_distribution<double> step(-0.1, 0.1);
        for (int frame = 0; frame < 10000; ++frame) {
            for (std::int64_t i = 0; i < count / 100; ++i) {
                const auto item = static_cast<boxtree::ItemId>(random() % boxes.size());
                boxes[item].center += glm::dvec3(step(random), step(random), step(random));
                if (!tree.move(item, boxes[item])) state.SkipWithError("move failed");
            }
            tree.refit();
            tree.rebuild_step(boxes.size() / 50);
        }
        aged.emplace(count, std::pair(std::move(boxes), std::move(tree)));
    }
    const auto& [boxes, old] = aged.at(count);
    const boxtree::BoxTree fresh_tree = *boxtree::BoxTree::build(boxes);
    const cull::View view = bench::view_of_share(boxes_of(count), 0.2);
    cull::VisibleSet visible;
    for (auto _ : state) {
        cull::find_visible(fresh ? fresh_tree : old, view, visible, {cull::CullMode::exact, cull::ResultOrder::tree});
        benchmark::DoNotOptimize(visible.ids().data());
    }
    report(state, visible.size());
    state.counters["boxes_tested"] = static_cast<double>(visible.statistics().boxes_tested);
}
BENCHMARK_CAPTURE(aged_cull, aged, false)->Arg(100000);
BENCHMARK_CAPTURE(aged_cull, fresh, true)->Arg(100000);

// Which tenth of the boxes moves: neighbours in the tree or any, numbered one after the other or as they come.
enum class Tenth { scattered, numbered_together, neighbours, neighbours_numbered };

struct Moving {
    std::vector<Obb> boxes;
    boxtree::BoxTree tree;
    std::vector<boxtree::ItemId> items;
    std::vector<Obb> moved;
    double step = 0.1;  // a tenth of the spacing, to and fro

    Moving(std::int64_t count, Tenth tenth)
        : boxes(tenth == Tenth::neighbours_numbered ? boxes_in_tree_order(count) : boxes_of(count)),
          tree(*boxtree::BoxTree::build(boxes)) {
        std::mt19937 random(1);
        for (std::size_t i = 0; i < boxes.size() / 10; ++i) {
            const auto any = static_cast<boxtree::ItemId>(random() % boxes.size());
            items.push_back(tenth == Tenth::scattered           ? any
                            : tenth == Tenth::numbered_together ? static_cast<boxtree::ItemId>(i)
                                                                : tree.structure().slot_items()[i]);
        }
        for (const boxtree::ItemId item : items) moved.push_back(boxes[item]);
    }
    void move() {
        for (Obb& box : moved) box.center.x += step;
        step = -step;
        if (!tree.move(items, moved)) std::abort();
        tree.refit();
    }
};

// The boxes move, the tree is refitted and asked; in a tree as it was built, or after a rebuild in the background,
// which has found out what moves.
void move_and_cull(benchmark::State& state, Tenth tenth, bool rebuilt) {
    Moving moving(state.range(0), tenth);
    if (rebuilt) {
        do moving.move();
        while (!moving.tree.rebuild_step(moving.boxes.size()));
    }
    const cull::View view = bench::view_of_share(moving.boxes, 0.2);
    cull::VisibleSet visible;
    for (auto _ : state) {
        moving.move();
        cull::find_visible(moving.tree, view, visible, {cull::CullMode::conservative, cull::ResultOrder::tree});
    }
    report(state, visible.size());
}
BENCHMARK_CAPTURE(move_and_cull, scattered, Tenth::scattered, false)
    ->Arg(100000)
    ->Arg(1000000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(move_and_cull, scattered_rebuilt, Tenth::scattered, true)
    ->Arg(1000000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(move_and_cull, numbered_together_rebuilt, Tenth::numbered_together, true)
    ->Arg(1000000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(move_and_cull, neighbours, Tenth::neighbours, false)->Arg(1000000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(move_and_cull, neighbours_numbered, Tenth::neighbours_numbered, false)
    ->Arg(1000000)
    ->Unit(benchmark::kMillisecond);

// The tenth is taken out of the tree and kept as a list over the caller's boxes. Parts of the frame: 0 the caller's
// own change of the boxes, 1 the list's update as well, 2 all.
void list_and_cull(benchmark::State& state, Tenth tenth, int part, cull::CullOptions options) {
    Moving moving(state.range(0), tenth);
    if (tenth == Tenth::scattered) {  // each once
        std::ranges::sort(moving.items);
        moving.items.erase(std::unique(moving.items.begin(), moving.items.end()), moving.items.end());
        std::ranges::shuffle(moving.items, std::mt19937(2));
    }
    moving.moved.clear();
    for (const boxtree::ItemId item : moving.items) moving.moved.push_back(moving.boxes[item]);
    moving.tree = *boxtree::BoxTree::build(moving.boxes, {.detached = moving.items});
    cull::MovingBoxes list;
    const cull::View view = bench::view_of_share(moving.boxes, 0.2);
    cull::VisibleSet visible;
    for (auto _ : state) {
        for (Obb& box : moving.moved) box.center.x += moving.step;
        moving.step = -moving.step;
        benchmark::ClobberMemory();
        if (part > 0 && !list.update(moving.tree, moving.items, moving.moved)) std::abort();
        if (part > 1) cull::find_visible(moving.tree, list, view, visible, options);
    }
    report(state, visible.size());
}
constexpr cull::CullOptions kPlanes{cull::CullMode::conservative, cull::ResultOrder::tree};
BENCHMARK_CAPTURE(list_and_cull, change, Tenth::scattered, 0, kPlanes)->Arg(1000000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(list_and_cull, update, Tenth::scattered, 1, kPlanes)->Arg(1000000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(list_and_cull, scattered, Tenth::scattered, 2, kPlanes)->Arg(1000000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(list_and_cull, numbered_together, Tenth::numbered_together, 2, kPlanes)
    ->Arg(1000000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(list_and_cull, neighbours, Tenth::neighbours, 2, kPlanes)
    ->Arg(1000000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(list_and_cull, neighbours_numbered, Tenth::neighbours_numbered, 2, kPlanes)
    ->Arg(1000000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(list_and_cull, scattered_exact, Tenth::scattered, 2,
                  (cull::CullOptions{cull::CullMode::exact, cull::ResultOrder::tree}))
    ->Arg(1000000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(list_and_cull, scattered_ascending, Tenth::scattered, 2, cull::CullOptions{})
    ->Arg(1000000)
    ->Unit(benchmark::kMillisecond);

// Another tenth changes in each frame, of a list of all; the list is told which, or looks at all. Choosing the tenth is
// not timed.
void list_of_all(benchmark::State& state, bool told) {
    std::vector<Obb> boxes = boxes_of(state.range(0));
    cull::BoxSet set;
    set.assign(boxes);
    const cull::View view = bench::view_of_share(boxes, 0.2);
    cull::VerdictBits bits;
    std::mt19937 random(1);
    std::vector<std::uint32_t> items(boxes.size() / 10);
    for (auto _ : state) {
        for (std::uint32_t& item : items) item = static_cast<std::uint32_t>(random() % boxes.size());
        const auto start = std::chrono::steady_clock::now();
        for (const std::uint32_t item : items) boxes[item].center.x += 0.01;
        if (told)
            set.update(items, boxes);
        else
            set.update(boxes);
        cull::find_visible(set, boxes, view, bits, cull::CullMode::conservative);
        state.SetIterationTime(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
}
BENCHMARK_CAPTURE(list_of_all, told, true)->Arg(1000000)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(list_of_all, looks, false)->Arg(1000000)->UseManualTime()->Unit(benchmark::kMillisecond);

// What memory allows: a tenth of the boxes is changed where it lies, read, and written where it belongs.
void move_floor(benchmark::State& state, Tenth tenth) {
    Moving moving(state.range(0), tenth);
    for (auto _ : state) {
        for (Obb& box : moving.moved) box.center.x += moving.step;
        moving.step = -moving.step;
        for (std::size_t i = 0; i < moving.items.size(); ++i) moving.boxes[moving.items[i]] = moving.moved[i];
        benchmark::ClobberMemory();
    }
}
BENCHMARK_CAPTURE(move_floor, scattered, Tenth::scattered)->Arg(1000000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(move_floor, numbered_together, Tenth::numbered_together)->Arg(1000000)->Unit(benchmark::kMillisecond);

// One whole rebuild in the background while a hundredth of the boxes moves every frame: how long the longest step
// takes, and the mean one.
void rebuild_steps(benchmark::State& state) {
    Moving moving(state.range(0), Tenth::numbered_together);
    moving.items.resize(moving.items.size() / 10);
    moving.moved.resize(moving.items.size());
    const auto budget = static_cast<std::size_t>(state.range(1));
    double longest = 0.0, sum = 0.0, steps = 0.0;
    for (auto _ : state) {
        bool done = false;
        while (!done) {
            moving.move();
            const auto start = std::chrono::steady_clock::now();
            done = moving.tree.rebuild_step(budget);
            const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            longest = std::max(longest, seconds);
            sum += seconds;
            ++steps;
        }
    }
    state.counters["steps"] = steps / static_cast<double>(state.iterations());
    state.counters["longest_us"] = 1e6 * longest;
    state.counters["mean_us"] = 1e6 * sum / steps;
}
BENCHMARK(rebuild_steps)->Args({1000000, 20000})->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
