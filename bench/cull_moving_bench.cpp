// Trees whose boxes move: an update and a query, and what long motion leaves behind.
#include <benchmark/benchmark.h>

#include <crofton/cull/cull.hpp>
#include <map>

#include "cull_inputs.hpp"

namespace {

using namespace crofton;
using bench::boxes_in_tree_order, bench::boxes_of, bench::report, bench::tree_of;

// After ten thousand frames of random motion, a hundredth of the boxes a frame by up to a tenth of the spacing, with
// bounded rebuilding in the background: a query beside one in a tree built afresh from the same boxes.
void aged_cull(benchmark::State& state, bool fresh) {
    static std::map<std::int64_t, std::pair<std::vector<Obb>, tree::BoxTree>> aged;
    const std::int64_t count = state.range(0);
    if (!aged.contains(count)) {
        std::vector<Obb> boxes = boxes_of(count);
        tree::BoxTree tree = *tree::BoxTree::build(boxes);
        std::mt19937 random(1);
        std::uniform_real_distribution<double> step(-0.1, 0.1);
        for (int frame = 0; frame < 10000; ++frame) {
            for (std::int64_t i = 0; i < count / 100; ++i) {
                const auto item = static_cast<tree::ItemId>(random() % boxes.size());
                boxes[item].center += glm::dvec3(step(random), step(random), step(random));
                if (!tree.move(item, boxes[item])) state.SkipWithError("move failed");
            }
            tree.refit();
            tree.maintain(boxes.size() / 50);
        }
        aged.emplace(count, std::pair(std::move(boxes), std::move(tree)));
    }
    const auto& [boxes, old] = aged.at(count);
    const tree::BoxTree fresh_tree = *tree::BoxTree::build(boxes);
    const cull::View view = bench::view_of_share(boxes_of(count), 0.2);
    cull::VisibleSet visible;
    for (auto _ : state) {
        cull::cull(fresh ? fresh_tree : old, view, visible, {cull::Mode::exact, cull::Order::tree});
        benchmark::DoNotOptimize(visible.ids().data());
    }
    report(state, visible.size());
    state.counters["boxes_tested"] = static_cast<double>(visible.statistics().boxes_tested);
}
BENCHMARK_CAPTURE(aged_cull, aged, false)->Arg(100000);
BENCHMARK_CAPTURE(aged_cull, fresh, true)->Arg(100000);

// A tenth of the boxes moves by a tenth of their spacing, chosen at random or neighbours in the tree, numbered at
// random or in the tree's order; then the tree is refitted and asked.
void move_and_cull(benchmark::State& state, bool scattered, bool numbered) {
    std::vector<Obb> boxes = numbered ? boxes_in_tree_order(state.range(0)) : boxes_of(state.range(0));
    tree::BoxTree tree = *tree::BoxTree::build(boxes);
    const cull::View view = bench::view_of_share(boxes, 0.2);
    std::mt19937 random(1);
    std::vector<tree::ItemId> items;
    for (std::size_t i = 0; i < boxes.size() / 10; ++i)
        items.push_back(scattered ? static_cast<tree::ItemId>(random() % boxes.size()) : tree.slot_items()[i]);
    std::vector<Obb> moved(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) moved[i] = boxes[items[i]];
    cull::VisibleSet visible;
    double step = 0.1;
    for (auto _ : state) {
        for (Obb& box : moved) box.center.x += step;
        step = -step;
        if (!tree.move(items, moved)) state.SkipWithError("move failed");
        tree.refit();
        cull::cull(tree, view, visible, {cull::Mode::conservative, cull::Order::tree});
    }
    report(state, visible.size());
}
BENCHMARK_CAPTURE(move_and_cull, scattered, true, false)->Arg(100000)->Arg(1000000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(move_and_cull, neighbours, false, false)->Arg(1000000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(move_and_cull, neighbours_numbered, false, true)->Arg(1000000)->Unit(benchmark::kMillisecond);

}  // namespace
