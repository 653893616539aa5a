// SPDX-License-Identifier: MIT
// Sets of the town: lines a second, what a frame pays for them, and how small they are.
// `bench_pvs [--target=NAME] [--benchmark_filter=…]`; counters: lines/s, ids (found by a view), bits a pair.
#include <benchmark/benchmark.h>

#include <crofton/boxtree/box_tree.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/pvs/pvs.hpp>
#include <crofton/sampling/sampling.hpp>
#include <vector>

#include "pipeline/pvs_scene.hpp"

namespace {

using namespace crofton;

struct Town {
    pvs::BakeGeometry geometry;
    Aabb eyes;
    boxtree::BoxTree tree;
    pvs::Pvs sets;
    std::vector<cull::View> views;
    std::vector<glm::dvec3> places;
    std::vector<std::vector<std::uint64_t>> halves;  // by place: a random half of the objects
};

// Frames that an eye is in a cell: half a second.
constexpr int kLongStay = 32;

pvs::Cells cells_over(const Aabb& eyes) {
    return pvs::Cells::grid(eyes, {64, 2, 64}).value();
}

Town make_town() {
    auto source = assets::load_scene("town").value();
    source.scene.update();
    auto geometry = pvs::geometry_of(source.scene, source.movers).value();
    const Aabb eyes = pipeline::eyes_of(source.scene, 10.0);
    auto bake = pvs::Bake::create(geometry, cells_over(eyes), {.epsilon = 6.6e-3}).value();
    (void)bake.run();
    auto tree = boxtree::BoxTree::build(geometry.boxes).value();
    Town town{std::move(geometry), eyes, std::move(tree), pvs::Pvs::finish(bake).value(), {}, {}, {}};
    sampling::Random random(11);
    Camera prototype;
    prototype.aspect = 16.0 / 9.0;
    for (int i = 0; i < 256; ++i) {
        town.places.push_back(sampling::box_point(eyes, random.point<3>()));
        auto& half = town.halves.emplace_back((town.geometry.boxes.size() + 63) / 64);
        for (std::uint64_t& word : half) word = random.bits();
    }
    for (int i = 0; i < 256 * kLongStay; ++i) {
        Camera camera = prototype;
        camera.position = town.places[static_cast<std::size_t>(i / kLongStay)];
        const glm::dvec2 ahead = sampling::circle_point(random.uniform());
        camera.forward = {ahead.x, 0.0, ahead.y};
        town.views.push_back({.frustum = frustum_of(camera).value()});
    }
    return town;
}

const Town& town() {
    static const Town made = make_town();
    return made;
}

// From the first line on: the first rounds are small, so that their lines are farther apart than those of a long bake.
void lines(benchmark::State& state) {
    const Town& t = town();
    const auto planned = pvs::Bake::create(t.geometry, cells_over(t.eyes), {.epsilon = 1e-4});
    double count = 0.0;
    for (auto _ : state) {
        state.PauseTiming();
        auto bake = pvs::Bake::create(t.geometry, cells_over(t.eyes), {.epsilon = 1e-4}).value();
        state.ResumeTiming();
        // A part of the last round.
        (void)bake.run({.lines = 1, .shard = {900, 1000}});
        count += static_cast<double>(bake.lines_done());
    }
    state.counters["lines/s"] = benchmark::Counter(count, benchmark::Counter::kIsRate);
    state.counters["planned"] = static_cast<double>(planned->lines_planned());
}
BENCHMARK(lines)->Unit(benchmark::kMillisecond)->Iterations(3);

// `range(0)`: the order of the answer. `range(1)`: frames at one place, each in another direction.
template <class Options>
void views(benchmark::State& state, const Options& options_for) {
    const Town& t = town();
    cull::VisibleSet visible;
    std::size_t i = 0;
    double ids = 0.0;
    const auto step = static_cast<std::size_t>(kLongStay / state.range(1));
    for (auto _ : state) {
        cull::CullOptions options = options_for(t, i / kLongStay);
        options.order = state.range(0) == 0 ? cull::ResultOrder::ascending : cull::ResultOrder::tree;
        cull::find_visible(t.tree, t.views[i], visible, options);
        ids += static_cast<double>(visible.size());
        i = (i + step) % t.views.size();
    }
    state.counters["ids"] = ids / static_cast<double>(state.iterations());
    state.SetLabel(state.range(0) == 0 ? "ascending" : "tree order");
}

void orders_and_stays(benchmark::internal::Benchmark* of) {
    of->ArgNames({"order", "stay"})->ArgsProduct({{0, 1}, {1, kLongStay}});
}

void view_frustum(benchmark::State& state) {
    views(state, [](const Town&, std::size_t) { return cull::CullOptions{}; });
}
BENCHMARK(view_frustum)->Apply(orders_and_stays);

void view_conservative(benchmark::State& state) {
    views(state, [](const Town& t, std::size_t i) {
        return cull::CullOptions{.candidate_mask = t.sets.visible_from(t.places[i], pvs::Mode::conservative)};
    });
}
BENCHMARK(view_conservative)->Apply(orders_and_stays);

// As many objects as proofs leave; without occluders the conservative sets hold all.
void view_half(benchmark::State& state) {
    views(state, [](const Town& t, std::size_t i) { return cull::CullOptions{.candidate_mask = t.halves[i]}; });
}
BENCHMARK(view_half)->Apply(orders_and_stays);

void view_statistical(benchmark::State& state) {
    views(state, [](const Town& t, std::size_t i) {
        return cull::CullOptions{.candidate_mask = t.sets.visible_from(t.places[i], pvs::Mode::statistical)};
    });
}
BENCHMARK(view_statistical)->Apply(orders_and_stays);

void write_file(benchmark::State& state) {
    const Town& t = town();
    std::size_t bytes = 0;
    for (auto _ : state) bytes = t.sets.to_file().value().size();
    state.counters["bits a pair"] =
        8.0 * static_cast<double>(bytes) / static_cast<double>(t.sets.cells().size() * t.sets.object_count());
}
BENCHMARK(write_file)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
