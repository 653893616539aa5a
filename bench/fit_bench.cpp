// SPDX-License-Identifier: MIT
// Boxes: time per fit beside CGAL's optimal_bounding_box and one DiTO-14 pass, and how far from the optimum the quicker
// qualities stay. Counters: ms (best repetition), cgal_ms, ratio = cgal_ms / ms, excess_percent.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <crofton/fit/fit.hpp>
#include <map>
#include <optional>
#include <string>

#include "fit_inputs.hpp"

namespace {

using namespace crofton;
using bench::Points;

const char* const kCriterionNames[] = {"volume", "area", "perimeter"};

measure::Criterion criterion_of(std::int64_t index) {
    return index == 0 ? measure::minimal_volume() : index == 1 ? measure::minimal_area() : measure::minimal_perimeter();
}

double optimum(const Points& points, const measure::Criterion& criterion) {
    return fit::fit_exact(std::span<const glm::vec3>(points), {.criterion = criterion}).value().value;
}

void exact(benchmark::State& state, const std::string& mesh) {
    const std::optional<Points> points = bench::load_points(mesh);
    if (!points) return state.SkipWithError("the mesh is not here");
    const measure::Criterion criterion = criterion_of(state.range(0));
    double ours = 1e300, gap = 0.0;
    for (auto _ : state)
        ours = std::min(
            ours, bench::best_milliseconds(20, [&] {
                gap = fit::fit_exact(std::span<const glm::vec3>(*points), {.criterion = criterion}).value().gap;
            }));
    state.SetLabel(kCriterionNames[state.range(0)]);
    state.counters["vertices"] = static_cast<double>(points->size());
    state.counters["ms"] = ours;
    state.counters["gap"] = gap;
    if (const std::optional<double> cgal = bench::cgal_milliseconds(*points, points->size() > 100000 ? 3 : 8)) {
        state.counters["cgal_ms"] = *cgal;
        state.counters["ratio"] = *cgal / ours;
    }
}

// `fast` beside one pass of DiTO-14's projections, as a plain loop compiled for the base instruction set.
void fast(benchmark::State& state, const std::string& mesh) {
    const std::optional<Points> points = bench::load_points(mesh);
    if (!points) return state.SkipWithError("the mesh is not here");
    const measure::Criterion criterion = criterion_of(state.range(0));
    double ours = 1e300, dito = 1e300;
    for (auto _ : state) {
        dito = std::min(dito,
                        bench::best_milliseconds(20, [&] { benchmark::DoNotOptimize(bench::dito14_pass(*points)); }));
        ours = std::min(ours, bench::best_milliseconds(20, [&] {
                            benchmark::DoNotOptimize(
                                fit::fit_obb(std::span<const glm::vec3>(*points), {criterion, fit::Quality::fast}));
                        }));
    }
    state.SetLabel(kCriterionNames[state.range(0)]);
    state.counters["ms"] = ours;
    state.counters["dito14_pass_ms"] = dito;
}

// Mean excess of the criterion over the optimum, on all meshes as they stand (range 1 = 0) and turned randomly (turns
// each).
void excess(benchmark::State& state, fit::Quality quality) {
    const measure::Criterion criterion = criterion_of(state.range(0));
    double sum = 0.0, worst = 0.0;
    int count = 0;
    for (auto _ : state)
        for (const std::string& mesh : bench::kMeshes) {
            const std::optional<Points> points = bench::load_points(mesh);
            if (!points) continue;
            const int turns = static_cast<int>(state.range(1));
            for (int turn = 0; turn < std::max(1, turns); ++turn) {
                const Points turned =
                    turns == 0 ? *points : bench::turned(*points, static_cast<std::uint32_t>(turn + 1));
                const Obb box = fit::fit_obb(std::span<const glm::vec3>(turned), {criterion, quality}).value();
                const double over =
                    criterion(measure::intrinsic_volumes_of_box(box)) / optimum(turned, criterion) - 1.0;
                sum += over;
                worst = std::max(worst, over);
                ++count;
            }
        }
    if (count == 0) return state.SkipWithError("the meshes are not here");
    state.SetLabel(std::string(kCriterionNames[state.range(0)]) +
                   (state.range(1) == 0 ? ", as they stand" : ", turned"));
    state.counters["excess_percent"] = 100.0 * sum / count;
    state.counters["worst_percent"] = 100.0 * worst;
}

// Boxes around clusters of one mesh: boxes a second, and their excess over the optimum. Flat clusters, whose optimum by
// volume is next to nothing, have no ratio and are left out of the excess.
void many(benchmark::State& state, const std::optional<bench::ClusteredMesh>& input, fit::Quality quality) {
    if (!input) return state.SkipWithError("the mesh is not here");
    const fit::Clusters clusters{input->positions, input->indices, input->ends};
    const measure::Criterion criterion = criterion_of(state.range(1));
    std::vector<Obb> boxes(input->ends.size()), best(boxes.size());
    for (auto _ : state) {
        auto done = fit::fit_many(clusters, {criterion, quality}, serial_executor(), boxes);
        benchmark::DoNotOptimize(done);
    }
    (void)fit::fit_many(clusters, {criterion, fit::Quality::exact}, serial_executor(), best);
    double sum = 0.0, worst = 0.0, counted = 0.0;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (state.range(1) == 0 && volume(best[i]) < 1e-6 * std::pow(edge_sum(best[i]), 3.0)) continue;
        const double over = criterion(measure::intrinsic_volumes_of_box(boxes[i])) /
                                criterion(measure::intrinsic_volumes_of_box(best[i])) -
                            1.0;
        sum += over;
        worst = std::max(worst, over);
        counted += 1.0;
    }
    state.SetLabel(kCriterionNames[state.range(1)]);
    state.counters["vertices"] = static_cast<double>(input->indices.size()) / static_cast<double>(boxes.size());
    state.counters["excess_percent"] = 100.0 * sum / counted;
    state.counters["worst_percent"] = 100.0 * worst;
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(boxes.size()));
}

// What fitting by one criterion costs in another: the mean over clusters of F and M of the boxes of least V, F and M.
void criterion_matters(benchmark::State& state, const std::string& mesh) {
    const std::optional<bench::ClusteredMesh> input =
        bench::load_clusters(mesh, static_cast<std::size_t>(state.range(0)));
    if (!input) return state.SkipWithError("the mesh is not here");
    const fit::Clusters clusters{input->positions, input->indices, input->ends};
    std::vector<Obb> boxes[3];
    for (auto _ : state)
        for (int c = 0; c < 3; ++c) {
            boxes[c].resize(input->ends.size());
            (void)fit::fit_many(clusters, {criterion_of(c), fit::Quality::exact}, serial_executor(), boxes[c]);
        }
    const auto mean_over = [&](int fitted, auto measure, int best, const char* name) {
        double sum = 0.0, worst = 0.0;
        for (std::size_t i = 0; i < boxes[0].size(); ++i) {
            const double over = measure(boxes[fitted][i]) / measure(boxes[best][i]) - 1.0;
            sum += over;
            worst = std::max(worst, over);
        }
        state.counters[std::string(name) + "_mean_%"] = 100.0 * sum / static_cast<double>(boxes[0].size());
        state.counters[std::string(name) + "_worst_%"] = 100.0 * worst;
    };
    mean_over(0, surface_area, 1, "F_of_minV");
    mean_over(2, surface_area, 1, "F_of_minM");
    mean_over(0, edge_sum, 2, "M_of_minV");
    mean_over(1, edge_sum, 2, "M_of_minF");
    state.counters["clusters"] = static_cast<double>(boxes[0].size());
}

void register_all() {
    for (const std::string& mesh : bench::kMeshes) {
        benchmark::RegisterBenchmark(("exact/" + mesh).c_str(), [mesh](benchmark::State& s) { exact(s, mesh); })
            ->DenseRange(0, 2)
            ->Iterations(1)
            ->Unit(benchmark::kMillisecond);
        benchmark::RegisterBenchmark(("fast/" + mesh).c_str(), [mesh](benchmark::State& s) { fast(s, mesh); })
            ->Arg(1)
            ->Iterations(1)
            ->Unit(benchmark::kMillisecond);
        benchmark::RegisterBenchmark(("criterion/" + mesh).c_str(),
                                     [mesh](benchmark::State& s) { criterion_matters(s, mesh); })
            ->Arg(mesh == bench::kScan ? 4096 : 1 << 30)
            ->Arg(32)
            ->Iterations(1)
            ->Unit(benchmark::kMillisecond);
    }
    for (const auto quality : {fit::Quality::fast, fit::Quality::tight}) {
        const std::string name = quality == fit::Quality::fast ? "fast" : "tight";
        benchmark::RegisterBenchmark(("excess/" + name).c_str(), [quality](benchmark::State& s) { excess(s, quality); })
            ->ArgsProduct({{0, 1, 2}, {0, 10}})
            ->Iterations(1)
            ->Unit(benchmark::kMillisecond);
        for (const std::string mesh : {"bunny", "armadillo", "fandisk"}) {
            benchmark::RegisterBenchmark(
                ("many/" + name + "/" + mesh + "/vertices").c_str(),
                [=](benchmark::State& s) {
                    many(s, bench::load_vertex_clusters(mesh, static_cast<std::size_t>(s.range(0))), quality);
                })
                ->ArgsProduct({{64}, {0, 1, 2}})
                ->Unit(benchmark::kMillisecond);
            benchmark::RegisterBenchmark(("many/" + name + "/" + mesh + "/triangles").c_str(),
                                         [=](benchmark::State& s) {
                                             many(s, bench::load_clusters(mesh, static_cast<std::size_t>(s.range(0))),
                                                  quality);
                                         })
                ->ArgsProduct({{8, 64}, {1}})
                ->Unit(benchmark::kMillisecond);
        }
    }
}

const int kRegistered = (register_all(), 0);

}  // namespace
