// SPDX-License-Identifier: MIT
// Scene::update on forests of 100,000 nodes with an instance each, beside a plain float loop that computes a 4×4 matrix
// a node and an aligned box (what engines with float transforms do). Prints nanoseconds a node. --target=NAME as for
// the other benchmarks.
#include <benchmark/benchmark.h>
#include <algorithm>
#include <chrono>
#include <crofton/scene/scene.hpp>
#include <ctime>
#include <glm/mat4x4.hpp>
#include <random>
#include <string>
#include <vector>

#include "simd_target.hpp"

namespace {

using namespace crofton;
using namespace crofton::scene;

constexpr std::size_t kNodes = 100'000;

enum class Forest { flat, grouped, chains };  // depth 1; depth 3 under one root; chains of four
const char* const kForestNames[] = {"depth_1", "depth_3", "chain_of_4"};

// The parent of node i. Parents have lower numbers.
std::uint32_t parent_of(Forest forest, std::size_t i) {
    if (forest == Forest::flat || i == 0) return kNone;
    if (forest == Forest::chains) return i % 4 == 0 ? kNone : static_cast<std::uint32_t>(i - 1);
    return i % 100 == 1 ? 0 : static_cast<std::uint32_t>((i - 1) / 100 * 100 + 1);
}

TriangleMesh random_mesh(std::mt19937& random) {
    std::uniform_real_distribution<float> number(-1.0f, 1.0f);
    TriangleMesh mesh;
    for (int i = 0; i < 24; ++i) {
        mesh.positions.emplace_back(number(random), 2.0f * number(random), 0.5f * number(random));
        mesh.indices.push_back(static_cast<std::uint32_t>(i));
    }
    return mesh;
}

// One in twenty is scaled unevenly, as crates and walls are.
Transform random_transform(std::mt19937& random, bool uneven) {
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    const glm::dquat turn = glm::normalize(glm::dquat(1.0, number(random), number(random), number(random)));
    Transform result{glm::mat3_cast(turn), {9.0 * number(random), 9.0 * number(random), 9.0 * number(random)}};
    if (uneven && random() % 20 == 0)
        for (int k = 0; k < 3; ++k) result.linear[k] *= 1.0 + 0.3 * number(random);
    return result;
}

struct Stage {
    Scene scene;
    std::vector<NodeId> nodes;
    std::vector<Transform> places[2];

    Stage(Forest forest, bool uneven) {
        std::mt19937 random(5);
        for (int m = 0; m < 64; ++m) (void)scene.add_mesh(random_mesh(random)).value();
        for (std::size_t i = 0; i < kNodes; ++i) {
            for (auto& place : places) place.push_back(random_transform(random, uneven));
            nodes.push_back(scene.add_node(parent_of(forest, i), places[0][i]).value());
            (void)scene.add_instance(nodes.back(), static_cast<MeshId>(random() % 64)).value();
        }
        scene.update();
    }
};

// The processor's time of this (one-threaded) program, which other programs do not lengthen; for short times, which
// its resolution does not tell, the clock on the wall.
class Stopwatch {
  public:
    [[nodiscard]] double seconds() const {
        const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count();
        return wall < 1e-4 ? wall : static_cast<double>(std::clock() - cpu_) / CLOCKS_PER_SEC;
    }

  private:
    std::clock_t cpu_ = std::clock();
    std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
};

// The least time of a frame: what the machine does when nobody disturbs it.
void report(benchmark::State& state, double least, std::uint64_t nodes) {
    state.counters["ns_a_node"] = 1e9 * least / static_cast<double>(nodes == 0 ? 1 : nodes);
}

// `moving` of 100 nodes get another transform before each update; only the update is timed.
void update(benchmark::State& state, Forest forest, bool uneven, std::size_t moving) {
    Stage stage(forest, uneven);
    std::uint64_t updated = 0;
    std::size_t frame = 0;
    double least = 1.0;
    for (auto each : state) {
        (void)each;
        ++frame;
        for (std::size_t i = 0; i < kNodes; ++i)
            if (i * 7 % 100 < moving) (void)stage.scene.set_local(stage.nodes[i], stage.places[frame % 2][i]);
        const Stopwatch watch;
        updated = stage.scene.update().nodes_updated;
        const double seconds = watch.seconds();
        state.SetIterationTime(seconds);
        least = std::min(least, seconds);
    }
    report(state, least, updated);
    state.counters["updated"] = static_cast<double>(updated);
}

struct FloatNode {
    glm::mat4 local, world;
    std::uint32_t parent;
};
struct FloatBox {
    glm::vec3 center, half_extents;
};

void float_loop(benchmark::State& state, Forest forest) {
    std::mt19937 random(5);
    std::vector<FloatNode> nodes;
    std::vector<FloatBox> meshes(64, FloatBox{glm::vec3(0.1f), glm::vec3(1.0f)}), boxes(kNodes);
    std::vector<std::uint32_t> mesh_of;
    for (std::size_t i = 0; i < kNodes; ++i) {
        const Transform place = random_transform(random, false);
        glm::mat4 local(glm::mat3(place.linear));
        local[3] = glm::vec4(glm::vec3(place.translation), 1.0f);
        nodes.push_back({local, local, parent_of(forest, i)});
        mesh_of.push_back(static_cast<std::uint32_t>(random() % 64));
    }
    double least = 1.0;
    for (auto each : state) {
        (void)each;
        const Stopwatch watch;
        for (std::size_t i = 0; i < kNodes; ++i) {
            FloatNode& node = nodes[i];
            node.world = node.parent == kNone ? node.local : nodes[node.parent].world * node.local;
            const FloatBox& mesh = meshes[mesh_of[i]];
            const glm::mat3 linear(node.world);
            const glm::mat3 size(glm::abs(linear[0]), glm::abs(linear[1]), glm::abs(linear[2]));
            boxes[i] = {linear * mesh.center + glm::vec3(node.world[3]), size * mesh.half_extents};
        }
        benchmark::DoNotOptimize(boxes.data());
        benchmark::ClobberMemory();
        least = std::min(least, watch.seconds());
    }
    report(state, least, kNodes);
}

void set_local(benchmark::State& state) {
    Stage stage(Forest::flat, false);
    std::size_t frame = 0;
    double least = 1.0;
    for (auto each : state) {
        (void)each;
        const Stopwatch watch;
        if (!stage.scene.set_local(stage.nodes, stage.places[++frame % 2])) std::abort();
        least = std::min(least, watch.seconds());
    }
    report(state, least, kNodes);
}

void register_all() {
    for (const Forest forest : {Forest::flat, Forest::grouped, Forest::chains})
        for (const bool uneven : {false, true})
            for (const std::size_t moving : {std::size_t{100}, std::size_t{1}, std::size_t{0}}) {
                if (uneven && moving != 100) continue;
                const std::string name = std::string("update/") + kForestNames[static_cast<int>(forest)] +
                                         (uneven ? "/uneven" : "/rigid") + "/moving_" + std::to_string(moving) +
                                         "_percent";
                benchmark::RegisterBenchmark(name.c_str(),
                                             [=](benchmark::State& state) { update(state, forest, uneven, moving); })
                    ->UseManualTime()
                    ->Iterations(50)
                    ->Unit(benchmark::kMicrosecond);
            }
    for (const Forest forest : {Forest::flat, Forest::grouped, Forest::chains})
        benchmark::RegisterBenchmark((std::string("float_loop/") + kForestNames[static_cast<int>(forest)]).c_str(),
                                     [=](benchmark::State& state) { float_loop(state, forest); })
            ->Unit(benchmark::kMicrosecond);
    benchmark::RegisterBenchmark("set_local/span", set_local)->Unit(benchmark::kMicrosecond);
}

}  // namespace

int main(int argc, char** argv) {
    if (!crofton::bench::take_target_option(argc, argv)) return 1;
    benchmark::AddCustomContext("instruction_set", crofton::bench::target_in_use());  // for bench/results.py
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    register_all();
    benchmark::RunSpecifiedBenchmarks();
}
