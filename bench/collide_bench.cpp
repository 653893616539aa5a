// SPDX-License-Identifier: MIT
// collide beside FCL, Bullet, Embree and ODE, on the same inputs in one run.
#include <benchmark/benchmark.h>

#include <crofton/collide/broadphase.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>

#include <deque>

#include "collide_inputs.hpp"

namespace crofton::bench {
namespace {

void box_pairs_streaming(benchmark::State& state) {
    const BoxPairs pairs = random_pairs(1'000'000);
    std::vector<std::uint8_t> hits(pairs.a.size());
    collide::BatchStatistics statistics;
    for (auto _ : state) statistics = collide::intersects(pairs.a, pairs.b, hits);
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(hits.size()));
    state.counters["hits"] = static_cast<double>(statistics.hits) / static_cast<double>(hits.size());
    state.counters["refined"] = static_cast<double>(statistics.refined);
}

void single_pairs(benchmark::State& state, BoxPairs (*pairs_of)(std::size_t)) {
    const BoxPairs pairs = pairs_of(4096);
    for (auto _ : state) {
        int hits = 0;
        for (std::size_t i = 0; i < pairs.a.size(); ++i) hits += collide::intersects(pairs.a[i], pairs.b[i]);
        benchmark::DoNotOptimize(hits);
    }
    state.SetItemsProcessed(state.iterations() * 4096);
}

void all_pairs(benchmark::State& state, bool exact) {
    std::vector<Obb> boxes = crowd(static_cast<std::size_t>(state.range(0)));
    collide::Broadphase broadphase({.exact_boxes = exact});
    int frame = 0;
    for (auto _ : state) {
        state.PauseTiming();
        move(boxes, frame++);
        state.ResumeTiming();
        const auto result = broadphase.update(boxes);
        if (!result) state.SkipWithError(result.error().message.c_str());
    }
    state.counters["leaf pairs/leaf"] =
        16.0 * static_cast<double>(broadphase.statistics().nodes_tested) / static_cast<double>(boxes.size());
    state.counters["pairs/box"] = static_cast<double>(broadphase.pairs().size()) / static_cast<double>(boxes.size());
}

struct MeshCase {
    TriangleMesh mesh;
    mesh::MeshTree tree;
    std::vector<RigidTransform> poses;
};

using mesh::MeshBoxes;

// The poses are the same for all kinds of boxes.
MeshCase* mesh_case(const std::string& name, benchmark::State& state, MeshBoxes boxes = MeshBoxes::small_perimeter) {
    static std::deque<std::pair<std::string, MeshCase>> cases;
    const std::string wanted = name + std::to_string(static_cast<int>(boxes));
    for (auto& [key, value] : cases)
        if (key == wanted) return &value;
    MeshCase made;
    made.mesh = shared_mesh(name);
    auto tree = mesh::MeshTree::build(made.mesh, {boxes});
    if (!tree) {
        state.SkipWithError("shared data is absent");
        return nullptr;
    }
    made.tree = std::move(*tree);
    made.poses = close_poses(*mesh::MeshTree::build(made.mesh, {MeshBoxes::principal_axes}), 1000);
    cases.emplace_back(wanted, std::move(made));
    return &cases.back().second;
}

// The mean edge sum of all boxes of a tree, for comparing kinds of boxes on the same splits.
double mean_edge_sum(const mesh::MeshTree& tree) {
    double sum = 0.0, count = 0.0;
    for (const mesh::MeshNode& node : tree.parts().nodes)
        for (std::uint32_t lane = 0; lane < node.count; ++lane, count += 1.0)
            for (int k = 0; k < 3; ++k) sum += 2.0 * static_cast<double>(node.half[k][lane]);
    return sum / count;
}

void mesh_any(benchmark::State& state, const char* name, MeshBoxes boxes = MeshBoxes::small_perimeter) {
    const MeshCase* input = mesh_case(name, state, boxes);
    if (input == nullptr) return;
    int hits = 0;
    mesh::MeshStatistics statistics;
    for (auto _ : state) {
        hits = 0;
        for (const RigidTransform& pose : input->poses) hits += mesh::intersects(input->tree, input->tree, pose);
    }
    for (const RigidTransform& pose : input->poses) (void)mesh::intersects(input->tree, input->tree, pose, &statistics);
    state.SetItemsProcessed(state.iterations() * 1000);
    state.counters["hits"] = hits;
    state.counters["boxes"] = static_cast<double>(statistics.box_tests) / 1000.0;
    state.counters["triangles"] = static_cast<double>(statistics.triangle_tests) / 1000.0;
    state.counters["exact"] = static_cast<double>(statistics.exact_tests) / 1000.0;
}

void mesh_all(benchmark::State& state, const char* name, MeshBoxes boxes = MeshBoxes::small_perimeter) {
    const MeshCase* input = mesh_case(name, state, boxes);
    if (input == nullptr) return;
    Vector<mesh::TrianglePair> pairs;
    std::size_t found = 0;
    mesh::MeshStatistics statistics;
    for (auto _ : state) {
        found = 0;
        for (const RigidTransform& pose : input->poses) {
            mesh::intersecting_triangles(input->tree, input->tree, pose, pairs);
            found += pairs.size();
        }
    }
    for (const RigidTransform& pose : input->poses)
        mesh::intersecting_triangles(input->tree, input->tree, pose, pairs, &statistics);
    state.SetItemsProcessed(state.iterations() * 1000);
    state.counters["pairs"] = static_cast<double>(found) / 1000.0;
    state.counters["boxes"] = static_cast<double>(statistics.box_tests) / 1000.0;
    state.counters["triangles"] = static_cast<double>(statistics.triangle_tests) / 1000.0;
    state.counters["exact"] = static_cast<double>(statistics.exact_tests) / 1000.0;
}

void mesh_build(benchmark::State& state, const char* name, MeshBoxes boxes = MeshBoxes::small_perimeter) {
    const MeshCase* input = mesh_case(name, state, boxes);
    if (input == nullptr) return;
    for (auto _ : state) benchmark::DoNotOptimize(mesh::MeshTree::build(input->mesh, {boxes}));
    state.counters["edge sum"] = mean_edge_sum(input->tree);
}

BENCHMARK(box_pairs_streaming)->Name("sat/1M pairs from boxes/crofton")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(single_pairs, random, random_pairs)
    ->Name("sat/4096 pairs one by one/crofton")
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(single_pairs, stacked, stacked_pairs)
    ->Name("sat/4096 stacked crates one by one/crofton")
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(single_pairs, grid, grid_pairs)
    ->Name("sat/4096 crates on a grid one by one/crofton")
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(all_pairs, bounds, false)
    ->Name("broadphase/bounds/crofton")
    ->Arg(1000)
    ->Arg(10000)
    ->Arg(100000)
    ->Arg(1000000)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(all_pairs, boxes, true)
    ->Name("broadphase/boxes/crofton")
    ->Arg(1000)
    ->Arg(10000)
    ->Arg(100000)
    ->Arg(1000000)
    ->Unit(benchmark::kMicrosecond);

// Kinds of boxes beside each other, the default under the name that the peers are compared with.
void mesh_benchmarks() {
    const struct {
        MeshBoxes boxes;
        const char* name;
    } kinds[] = {{MeshBoxes::small_perimeter, "crofton"},
                 {MeshBoxes::principal_axes, "principal axes"},
                 {MeshBoxes::least_perimeter, "least perimeter"}};
    for (const auto& kind : kinds) {
        const auto add = [&](const std::string& name, auto measure) {
            benchmark::RegisterBenchmark(("mesh/" + name + "/" + kind.name).c_str(), measure)
                ->Unit(benchmark::kMillisecond);
        };
        const MeshBoxes boxes = kind.boxes;
        for (const char* mesh : {"bunny", "cow"}) {
            add(mesh + std::string(" any"), [=](benchmark::State& state) { mesh_any(state, mesh, boxes); });
            add(mesh + std::string(" all"), [=](benchmark::State& state) { mesh_all(state, mesh, boxes); });
            add(mesh + std::string(" build"), [=](benchmark::State& state) { mesh_build(state, mesh, boxes); });
        }
    }
}
const bool registered = (mesh_benchmarks(), true);

}  // namespace
}  // namespace crofton::bench
