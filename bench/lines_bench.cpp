// SPDX-License-Identifier: MIT
// The same job twice: all crossings along uniform lines, stored and sorted, by LineTracer and by Embree's packets of
// sixteen; and the time to build either. `bench_lines [--target=NAME] [--benchmark_filter=…]`; counters: lines/s.
#include <benchmark/benchmark.h>

#include <crofton/lines/lines.hpp>
#include <map>
#include <memory>
#include <string>

#include "assets/flat_scene.hpp"
#include "lines_peer.hpp"

namespace {

using namespace crofton;
using namespace crofton::lines;

struct Job {
    const char* name;
    const char* file;
    const char* map;
};
const std::string kShared = std::string(CROFTON_SHARED_DATA) + "/scenes/";
constexpr Job kJobs[] = {{"town", "town", ""},
                         {"room", "room", ""},
                         {"dungeon", "recast_dungeon.obj", ""},
                         {"MAP01", "freedoom2_maps.wad", "MAP01"},
                         {"MAP07", "freedoom2_maps.wad", "MAP07"},
                         {"forest", "stk_black_forest.glb", ""}};

struct Scene {
    TriangleMesh mesh;
    std::unique_ptr<LineTracer> ours;
    std::unique_ptr<bench::EmbreeScene> theirs;
};

const Scene& scene(std::int64_t which) {
    static std::map<std::int64_t, Scene> scenes;
    Scene& made = scenes[which];
    if (made.ours) return made;
    const Job& job = kJobs[which];
    const bool own = job.file == std::string("town") || job.file == std::string("room");
    auto source = assets::load_scene(own ? job.file : kShared + job.file, {.map = job.map});
    source->scene.update();
    made.mesh = assets::flat_scene(*source).value().mesh;
    made.ours = std::make_unique<LineTracer>(LineTracer::build(made.mesh).value());
    if (bench::EmbreeScene::available()) made.theirs = std::make_unique<bench::EmbreeScene>(made.mesh);
    return made;
}

template <class Trace>
void all_crossings(benchmark::State& state, const Scene& s, const Trace& trace) {
    const LineSource source(s.ours->bounds(), LineMethod::walls, 3);
    constexpr std::uint64_t kBlocks = 64;
    Vector<Line> block, lines;
    for (std::uint64_t b = 0; b < kBlocks; ++b) {
        source.draw(b, block);
        lines.insert(lines.end(), block.begin(), block.end());
    }
    LineHits hits;
    for (auto _ : state) trace(lines, hits);
    const auto drawn = static_cast<double>(lines.size());
    state.counters["lines/s"] =
        benchmark::Counter(drawn * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
    state.counters["crossings"] = static_cast<double>(hits.hits.size()) / drawn;
    state.SetLabel(kJobs[state.range(0)].name);
}

void crossings_ours(benchmark::State& state) {
    const Scene& s = scene(state.range(0));
    all_crossings(state, s, [&](std::span<const Line> lines, LineHits& hits) { s.ours->all_hits(lines, hits); });
}
BENCHMARK(crossings_ours)->DenseRange(0, 5)->Unit(benchmark::kMillisecond);

void crossings_embree(benchmark::State& state) {
    const Scene& s = scene(state.range(0));
    if (!s.theirs) return state.SkipWithError("Embree is not installed");
    all_crossings(state, s, [&](std::span<const Line> lines, LineHits& hits) { s.theirs->all_hits(lines, hits); });
}
BENCHMARK(crossings_embree)->DenseRange(0, 5)->Unit(benchmark::kMillisecond);

void build_ours(benchmark::State& state) {
    const Scene& s = scene(state.range(0));
    for (auto _ : state) benchmark::DoNotOptimize(LineTracer::build(s.mesh).value().bytes());
    state.SetLabel(kJobs[state.range(0)].name);
}
BENCHMARK(build_ours)->DenseRange(0, 5)->Unit(benchmark::kMillisecond);

void build_embree(benchmark::State& state) {
    const Scene& s = scene(state.range(0));
    if (!bench::EmbreeScene::available()) return state.SkipWithError("Embree is not installed");
    for (auto _ : state) benchmark::DoNotOptimize(std::make_unique<bench::EmbreeScene>(s.mesh));
    state.SetLabel(kJobs[state.range(0)].name);
}
BENCHMARK(build_embree)->DenseRange(0, 5)->Unit(benchmark::kMillisecond);

}  // namespace
