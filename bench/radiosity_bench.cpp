// SPDX-License-Identifier: MIT
// Global lines a second, one by one and in bundles, and the error of all form factors at equal time beside local lines
// cast by Embree. `bench_radiosity --benchmark_filter=…`; counters: lines/s, crossings/s, rms.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <crofton/lines/lines.hpp>
#include <crofton/radiosity/patches.hpp>
#include <crofton/sampling/sampling.hpp>
#include <memory>
#include <string>
#include <unordered_map>

#include "assets/flat_scene.hpp"
#include "radiosity_peers.hpp"

namespace {

using namespace crofton;
using namespace crofton::lines;
using namespace crofton::radiosity;
using Clock = std::chrono::steady_clock;

struct Scene {
    Patches patches;
    LineTracer lines;
    BundleTracer bundles;
    std::unique_ptr<bench::EmbreeScene> embree;
    double box_area = 0.0;

    // Cell of a bundle with this many lines on average over directions.
    [[nodiscard]] double cell_area(double count) const { return 0.25 * box_area / count; }
};

// Triangles of at most `edge` metres (0: as they are), each a patch.
Scene make_scene(const char* name, double edge) {
    auto source = assets::load_scene(name);
    source->scene.update();
    TriangleMesh mesh = assets::flat_scene(*source).value().mesh;
    if (edge > 0.0) mesh = std::move(refine(mesh, edge)->mesh);
    const Vector<Material> materials(mesh.triangle_count());
    Patches patches = std::move(*make_patches(std::move(mesh), materials));
    auto lines = LineTracer::build(patches.mesh);
    auto bundles = BundleTracer::build(patches.mesh);
    Scene scene{std::move(patches), std::move(*lines), std::move(*bundles), nullptr, 0.0};
    if (bench::EmbreeScene::available()) scene.embree = std::make_unique<bench::EmbreeScene>(scene.patches.mesh);
    scene.box_area = LineSource(scene.lines.bounds(), LineMethod::walls, 1).surface_area();
    return scene;
}
const Scene& scene(int which) {
    static const Scene scenes[] = {make_scene("room", 0.2), make_scene("town", 0.0)};
    return scenes[which];
}
const char* scene_name(int which) {
    return which == 0 ? "room" : "town";
}

void lines_one_by_one(benchmark::State& state) {
    const Scene& s = scene(static_cast<int>(state.range(0)));
    const LineSource source(s.lines.bounds(), LineMethod::walls, 3, sampling::Sequence::quasi_random);
    Vector<Line> lines;
    LineHits hits;
    double count = 0.0, crossings = 0.0;
    std::uint64_t block = 0;
    for (auto _ : state) {
        source.draw(block++, lines);
        s.lines.all_hits(lines, hits);
        count += static_cast<double>(lines.size());
        crossings += static_cast<double>(hits.hits.size());
    }
    state.SetLabel(scene_name(static_cast<int>(state.range(0))));
    state.counters["lines/s"] = benchmark::Counter(count, benchmark::Counter::kIsRate);
    state.counters["crossings/s"] = benchmark::Counter(crossings, benchmark::Counter::kIsRate);
}
BENCHMARK(lines_one_by_one)->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

void lines_in_bundles(benchmark::State& state) {
    const Scene& s = scene(static_cast<int>(state.range(0)));
    const sampling::UnitPoints points(3, sampling::Sequence::quasi_random);
    BundleTracer::Scratch scratch;
    LineHits hits;
    double count = 0.0, crossings = 0.0;
    std::uint64_t k = 0;
    for (auto _ : state) {
        const Bundle bundle =
            make_bundle(s.bundles.bounds(), s.cell_area(static_cast<double>(state.range(1))), points.at<2>(k), k);
        ++k;
        s.bundles.all_hits(bundle, scratch, hits);
        count += bundle.lines;
        crossings += static_cast<double>(hits.hits.size());
    }
    state.SetLabel(scene_name(static_cast<int>(state.range(0))));
    state.counters["lines/s"] = benchmark::Counter(count, benchmark::Counter::kIsRate);
    state.counters["crossings/s"] = benchmark::Counter(crossings, benchmark::Counter::kIsRate);
}
BENCHMARK(lines_in_bundles)
    ->ArgsProduct({{0, 1}, {1 << 12, 1 << 14, 1 << 16, 1 << 18, 1 << 20}})
    ->Unit(benchmark::kMillisecond);

// Transfers i → j of a sample of the rows, from everything that was traced.
class SampledRows {
  public:
    static constexpr std::uint32_t kEvery = 64;
    explicit SampledRows(const Patches& patches) : patches_(patches), rays_(patches.count(), 0) {}

    void add(std::uint32_t i, std::uint32_t j) {
        ++rays_[i];
        if (i % kEvery == 0 && j < kBack) ++transfers_[std::uint64_t{i} << 32 | j];
    }

    // Root of the area-weighted mean over the rows of Σ_j (difference to `other`)², over √2: for two independent
    // unbiased estimates that is the error of either. A row that either has no ray of counts as 1, more than it can be.
    [[nodiscard]] double rms_against(const SampledRows& other) const {
        double sum = 0.0, area = 0.0;
        const auto add = [&](std::uint64_t key) {
            const std::size_t i = key >> 32;
            if (rays_[i] == 0 || other.rays_[i] == 0) return;
            const auto factor = [&](const SampledRows& rows) {
                const auto found = rows.transfers_.find(key);
                return found == rows.transfers_.end()
                           ? 0.0
                           : static_cast<double>(found->second) / static_cast<double>(rows.rays_[i]);
            };
            sum += patches_.areas[i] * std::pow(factor(*this) - factor(other), 2.0);
        };
        for (const auto& [key, count] : transfers_) add(key);
        for (const auto& [key, count] : other.transfers_)
            if (!transfers_.contains(key)) add(key);
        for (std::size_t i = 0; i < rays_.size(); i += kEvery) {
            area += patches_.areas[i];
            if (rays_[i] == 0 || other.rays_[i] == 0) sum += 2.0 * patches_.areas[i];
        }
        return std::sqrt(0.5 * sum / area);
    }
    [[nodiscard]] double rays() const {
        double sum = 0.0;
        for (const std::uint64_t n : rays_) sum += static_cast<double>(n);
        return sum;
    }

  private:
    const Patches& patches_;
    Vector<std::uint64_t> rays_;
    std::unordered_map<std::uint64_t, std::uint64_t> transfers_;
};

void visit(const LineHits& hits, const Patches& patches, SampledRows& rows) {
    std::uint32_t begin = 0;
    for (const std::uint32_t end : hits.ends) {
        for_each_ray(std::span<const Hit>(hits.hits).subspan(begin, end - begin), patches,
                     [&](std::uint32_t i, std::uint32_t j) { rows.add(i, j); });
        begin = end;
    }
}

// Two independent estimates, each `seconds` of tracing; keeping the sample's transfers is left out of the time, for all
// alike.
template <class Step>
void measure_factors(benchmark::State& state, const Scene& s, double seconds, Step&& step) {
    for (auto _ : state) {
        SampledRows rows[2] = {SampledRows(s.patches), SampledRows(s.patches)};
        for (std::uint64_t half = 0; half < 2; ++half) {
            double spent = 0.0;
            for (std::uint64_t k = 0; spent < seconds; ++k) spent += step(half + 1, k, rows[half]);
        }
        state.counters["rms"] = rows[0].rms_against(rows[1]);
        state.counters["rays/s"] = rows[0].rays() / seconds;
    }
}
double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

constexpr double kSeconds = 2.0;

void factors_by_bundles(benchmark::State& state) {
    const Scene& s = scene(static_cast<int>(state.range(0)));
    const double area = s.cell_area(static_cast<double>(state.range(1)));
    BundleTracer::Scratch scratch;
    LineHits hits;
    measure_factors(state, s, kSeconds, [&](std::uint64_t seed, std::uint64_t k, SampledRows& rows) {
        const auto start = Clock::now();
        const sampling::UnitPoints points(seed, sampling::Sequence::quasi_random);
        s.bundles.all_hits(make_bundle(s.bundles.bounds(), area, points.at<2>(k), seed << 32 | k), scratch, hits);
        const double spent = seconds_since(start);
        visit(hits, s.patches, rows);
        return spent;
    });
    state.SetLabel(scene_name(static_cast<int>(state.range(0))));
}
BENCHMARK(factors_by_bundles)
    ->ArgsProduct({{0}, {1 << 12, 1 << 14}})
    ->ArgsProduct({{1}, {1 << 16, 1 << 18}})
    ->Iterations(1)
    ->Unit(benchmark::kSecond);

void factors_by_global_lines(benchmark::State& state) {
    const Scene& s = scene(static_cast<int>(state.range(0)));
    Vector<Line> lines;
    LineHits hits;
    measure_factors(state, s, kSeconds, [&](std::uint64_t seed, std::uint64_t k, SampledRows& rows) {
        const auto start = Clock::now();
        LineSource(s.lines.bounds(), LineMethod::walls, seed, sampling::Sequence::quasi_random).draw(k, lines);
        s.lines.all_hits(lines, hits);
        const double spent = seconds_since(start);
        visit(hits, s.patches, rows);
        return spent;
    });
    state.SetLabel(scene_name(static_cast<int>(state.range(0))));
}
BENCHMARK(factors_by_global_lines)->Arg(0)->Arg(1)->Iterations(1)->Unit(benchmark::kSecond);

// Local lines from all patches in turn, the same number from each: what minimises Σ 1/n over the rows at a given total.
// One ray per patch and round; drawing points and directions is counted, as it is for global lines.
template <class Cast>
void factors_by_local_lines(benchmark::State& state, Cast&& cast) {
    const Scene& s = scene(static_cast<int>(state.range(0)));
    constexpr std::uint32_t kBatch = 1024;
    std::vector<FirstHitQuery> rays;
    std::vector<Hit> hits(kBatch);
    const auto count = static_cast<std::uint32_t>(s.patches.count());
    const std::uint32_t batches = (count + kBatch - 1) / kBatch;
    measure_factors(state, s, kSeconds, [&](std::uint64_t seed, std::uint64_t k, SampledRows& rows) {
        const auto start = Clock::now();
        const std::uint32_t begin = static_cast<std::uint32_t>(k % batches) * kBatch,
                            end = std::min(count, begin + kBatch);
        sampling::Random random(seed, k);
        rays.clear();
        for (std::uint32_t i = begin; i < end; ++i) {
            const auto corner = [&](std::uint32_t c) {
                return glm::dvec3(s.patches.mesh.positions[s.patches.mesh.indices[3 * i + c]]);
            };
            const glm::dvec3 a = corner(0), u = corner(1) - a, v = corner(2) - a;
            double x = random.uniform(), y = random.uniform();
            if (x + y > 1.0) x = 1.0 - x, y = 1.0 - y;
            rays.push_back(
                {{a + x * u + y * v, sampling::cosine_direction(glm::normalize(glm::cross(u, v)), random.point<2>())},
                 i});
        }
        cast(s, std::span<const FirstHitQuery>(rays), std::span(hits).first(rays.size()));
        const double spent = seconds_since(start);
        for (std::size_t r = 0; r < rays.size(); ++r)
            rows.add(begin + static_cast<std::uint32_t>(r), hits[r].triangle == Hit::kNothing ? kSky
                                                            : hits[r].front                   ? hits[r].triangle
                                                                                              : kBack);
        return spent;
    });
    state.SetLabel(scene_name(static_cast<int>(state.range(0))));
}
void factors_by_local_lines_ours(benchmark::State& state) {
    factors_by_local_lines(state, [](const Scene& s, auto rays, auto hits) { s.lines.first_hits(rays, hits); });
}
BENCHMARK(factors_by_local_lines_ours)->Arg(0)->Arg(1)->Iterations(1)->Unit(benchmark::kSecond);
void factors_by_local_lines_embree(benchmark::State& state) {
    if (!bench::EmbreeScene::available()) return state.SkipWithError("Embree is not installed");
    factors_by_local_lines(state, [](const Scene& s, auto rays, auto hits) { s.embree->first_hits(rays, hits); });
}
BENCHMARK(factors_by_local_lines_embree)->Arg(0)->Arg(1)->Iterations(1)->Unit(benchmark::kSecond);

}  // namespace
