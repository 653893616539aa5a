// SPDX-License-Identifier: MIT
// What a frame of a game asks of collide: few movers among many boxes, single pairs near touching, meshes that deform.
#include <benchmark/benchmark.h>

#include <crofton/collide/bound_contacts.hpp>
#include <crofton/collide/broadphase.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>

#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <random>

#include "collide_inputs.hpp"

namespace crofton::bench {
namespace {

// Random pairs brought to touching along the line of centres, then 1e-3 of their size apart or into each other.
BoxPairs near_touching_pairs(std::size_t count) {
    BoxPairs pairs = random_pairs(count);
    for (std::size_t i = 0; i < count; ++i) {
        const glm::dvec3 from = pairs.a[i].center, way = pairs.b[i].center - from;
        double near = 0.0, far = 8.0;
        for (int step = 0; step < 40; ++step) {
            const double middle = 0.5 * (near + far);
            pairs.b[i].center = from + middle * way;
            (collide::intersects(pairs.a[i], pairs.b[i]) ? near : far) = middle;
        }
        pairs.b[i].center = from + (near + (i % 2 == 0 ? 1e-3 : -1e-3) / glm::length(way)) * way;
    }
    return pairs;
}

template <class Ask>
void ask_pairs(benchmark::State& state, const BoxPairs& pairs, Ask ask) {
    for (auto _ : state)
        for (std::size_t i = 0; i < pairs.a.size(); ++i) benchmark::DoNotOptimize(ask(pairs.a[i], pairs.b[i]));
    state.counters["ns/pair"] =
        benchmark::Counter(static_cast<double>(pairs.a.size()) * 1e-9,
                           benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void pair_meets(benchmark::State& state) {
    ask_pairs(state, near_touching_pairs(1024), [](const Obb& a, const Obb& b) { return collide::intersects(a, b); });
}
void pair_manifold(benchmark::State& state) {
    BoxPairs near = near_touching_pairs(2048), pairs;  // those that meet
    for (std::size_t i = 1; i < near.a.size(); i += 2) {
        pairs.a.push_back(near.a[i]);
        pairs.b.push_back(near.b[i]);
    }
    ask_pairs(state, pairs, [](const Obb& a, const Obb& b) { return collide::contact_manifold(a, b).count; });
}
void stacked_manifold(benchmark::State& state) {
    BoxPairs pairs = stacked_pairs(1024);
    for (std::size_t i = 0; i < pairs.a.size(); ++i)
        pairs.b[i].center = pairs.a[i].center + 0.999 * (pairs.b[i].center - pairs.a[i].center);
    ask_pairs(state, pairs, [](const Obb& a, const Obb& b) { return collide::contact_manifold(a, b).count; });
}
void pair_distance(benchmark::State& state) {
    BoxPairs near = near_touching_pairs(2048), pairs;  // those that are apart
    for (std::size_t i = 0; i < near.a.size(); i += 2) {
        pairs.a.push_back(near.a[i]);
        pairs.b.push_back(near.b[i]);
    }
    ask_pairs(state, pairs, [](const Obb& a, const Obb& b) { return collide::distance(a, b).distance; });
}

// range(0) boxes of which so many move.
void move_some(benchmark::State& state, std::size_t movers) {
    std::vector<Obb> boxes = crowd(static_cast<std::size_t>(state.range(0)));
    collide::Broadphase broadphase;
    (void)broadphase.update(boxes);
    std::mt19937_64 random(3);
    std::vector<std::uint32_t> moved(movers);
    int frame = 0;
    for (auto _ : state) {
        state.PauseTiming();
        if (movers == boxes.size()) {
            move(boxes, frame++);
        } else {
            for (std::size_t m = 0; m < movers; ++m) {
                moved[m] = static_cast<std::uint32_t>(random() % boxes.size());
                Obb& box = boxes[moved[m]];
                box.center += 0.05 * glm::dvec3(random() % 2 ? 1.0 : -1.0, 0.3, random() % 2 ? 0.7 : -0.7);
            }
        }
        state.ResumeTiming();
        benchmark::DoNotOptimize(movers == boxes.size() ? broadphase.update(boxes).has_value()
                                                        : broadphase.update_moved(boxes, moved).has_value());
    }
    state.counters["pairs"] = static_cast<double>(broadphase.pairs().size());
}
void few_movers(benchmark::State& state) {  // range(1) per mille
    move_some(state, static_cast<std::size_t>(state.range(0) * state.range(1) / 1000));
}
void one_mover(benchmark::State& state) {
    move_some(state, 1);
}

void mesh_refit(benchmark::State& state) {
    TriangleMesh mesh = shared_mesh("bunny");
    auto tree = mesh::MeshTree::build(mesh, {.refittable = true, .rays = true});
    if (!tree) return state.SkipWithError("shared data is absent");
    std::vector<glm::vec3> bent[2];
    for (std::size_t k = 0; k < 2; ++k)
        for (const glm::vec3& p : mesh.positions)
            bent[k].push_back(p + glm::vec3(0.0f, 0.1f * static_cast<float>(k) * p.x * p.x, 0.0f));
    std::size_t frame = 0;
    for (auto _ : state) benchmark::DoNotOptimize(tree->refit(bent[frame++ % 2]).has_value());
    state.counters["triangles"] = static_cast<double>(tree->triangle_count());
}

void mesh_contacts(benchmark::State& state, bool manifold) {
    const TriangleMesh mesh = shared_mesh("bunny");
    const auto tree = mesh::MeshTree::build(mesh, {.rays = true});
    if (!tree) return state.SkipWithError("shared data is absent");
    const auto poses = close_poses(*tree, 100);
    Vector<mesh::MeshContact> found;
    std::size_t count = 0;
    for (auto _ : state) {
        count = 0;
        for (const RigidTransform& pose : poses) {
            mesh::contacts(*tree, *tree, pose, found);
            count += found.size();
            if (manifold) benchmark::DoNotOptimize(collide::contact_manifold(*tree, *tree, pose, found).depth);
        }
    }
    state.counters["contacts"] = static_cast<double>(count) / 100.0;
    state.counters["us/pose"] =
        benchmark::Counter(100.0 * 1e-6, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

BENCHMARK(pair_meets)->Name("pair/meets, near touching/crofton")->Unit(benchmark::kMicrosecond);
BENCHMARK(pair_manifold)->Name("pair/manifold, near touching/crofton")->Unit(benchmark::kMicrosecond);
BENCHMARK(stacked_manifold)->Name("pair/manifold, stacked/crofton")->Unit(benchmark::kMicrosecond);
BENCHMARK(pair_distance)->Name("pair/distance, near touching/crofton")->Unit(benchmark::kMicrosecond);
BENCHMARK(few_movers)
    ->Name("broadphase/movers per mille/crofton")
    ->ArgsProduct({{10000, 100000, 1000000}, {0, 10, 100, 1000}})
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(one_mover)
    ->Name("broadphase/one mover/crofton")
    ->Arg(10000)
    ->Arg(100000)
    ->Arg(1000000)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(mesh_refit)->Name("mesh/bunny refit/crofton")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(mesh_contacts, contacts, false)->Name("mesh/bunny contacts/crofton")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(mesh_contacts, manifold, true)
    ->Name("mesh/bunny contacts and manifold/crofton")
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace crofton::bench
