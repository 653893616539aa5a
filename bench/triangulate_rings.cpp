// SPDX-License-Identifier: MIT
// Rings whose diagonals nearly all tie or survive every pruning: regular polygons, smooth curves, strips. A plain
// interval programme and, where installed, earcut are measured beside ours.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <crofton/triangulate/triangulate.hpp>
#include <limits>
#include <map>
#include <numbers>

#include "triangulate_inputs.hpp"

#if __has_include(<mapbox/earcut.hpp>)
#include <array>
#include <mapbox/earcut.hpp>
#define CROFTON_HAVE_EARCUT 1
#endif

using namespace crofton;
using triangulate::Method;

namespace {

const std::string kFolder = std::string(CROFTON_SHARED_DATA) + "/polygons/";

Polygon one_ring(std::vector<glm::dvec2> points) {
    Polygon result;
    result.points.assign(points.begin(), points.end());
    result.ring_ends.push_back(static_cast<std::uint32_t>(points.size()));
    return result;
}

Polygon regular(std::size_t count) {
    std::vector<glm::dvec2> points;
    for (std::size_t i = 0; i < count; ++i) {
        const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
        points.emplace_back(1000.0 * std::cos(angle), 1000.0 * std::sin(angle));
    }
    return one_ring(std::move(points));
}

// r = 1 + 0.2 sin 3θ + 0.1 sin 7θ: convex and concave arcs, no corner.
Polygon smooth(std::size_t count) {
    std::vector<glm::dvec2> points;
    for (std::size_t i = 0; i < count; ++i) {
        const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
        const double radius = 1000.0 * (1.0 + 0.2 * std::sin(3.0 * angle) + 0.1 * std::sin(7.0 * angle));
        points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    return one_ring(std::move(points));
}

// A band of height 1, `count` vertices, half of them along either side.
Polygon strip(std::size_t count) {
    std::vector<glm::dvec2> points;
    const std::size_t half = count / 2;
    for (std::size_t i = 0; i < half; ++i) points.emplace_back(static_cast<double>(i), 0.0);
    for (std::size_t i = half; i-- > 0;) points.emplace_back(static_cast<double>(i), 1.0);
    return one_ring(std::move(points));
}

// A strip bent into waves.
Polygon ribbon(std::size_t count) {
    Polygon result = strip(count);
    for (auto& p : result.points) p.y += 5.0 * std::sin(0.05 * p.x);
    return result;
}

void measure(benchmark::State& state, const Polygon& polygon, const triangulate::TriangulateOptions& options) {
    triangulate::Triangulator triangulator;
    triangulate::Triangulation result;
    for (auto _ : state) {
        if (!triangulator.triangulate(polygon, options, result)) return state.SkipWithError("refused");
    }
    state.counters["us_per_vertex"] =
        benchmark::Counter(static_cast<double>(polygon.points.size()) * static_cast<double>(state.iterations()) * 1e-6,
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    state.counters["vertices"] = static_cast<double>(polygon.points.size());
    state.counters["weight"] = result.weight;
    state.counters["proven"] = result.optimal;
    state.counters["gap"] = result.gap;
}

void ring(benchmark::State& state, Polygon (*make)(std::size_t), Method method) {
    measure(state, make(static_cast<std::size_t>(state.range(0))), {.method = method});
}
BENCHMARK_CAPTURE(ring, regular, regular, Method::minimum_weight)
    ->Arg(8)
    ->Arg(16)
    ->Arg(32)
    ->Arg(64)
    ->Arg(128)
    ->Arg(256)
    ->Arg(512)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ring, smooth, smooth, Method::minimum_weight)->Arg(512)->Arg(2000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ring, strip_ear, strip, Method::ear)->Arg(1000)->Arg(8000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ring, ribbon_ear, ribbon, Method::ear)->Arg(1000)->Arg(8000)->Unit(benchmark::kMillisecond);

// What is returned when the search ends before it has begun: compare the weights with those of the lines above.
void ring_without_work(benchmark::State& state, Polygon (*make)(std::size_t)) {
    measure(state, make(static_cast<std::size_t>(state.range(0))), {.work = 0});
}
BENCHMARK_CAPTURE(ring_without_work, regular, regular)->Arg(512)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ring_without_work, smooth, smooth)->Arg(512)->Arg(2000)->Arg(15000)->Unit(benchmark::kMillisecond);
// Too large to be proven: ends at the limit of memory.
BENCHMARK_CAPTURE(ring, smooth_unproven, smooth, Method::minimum_weight)
    ->Arg(15000)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

// The textbook's programme on a convex ring: three loops over doubles, no bound on rounding, ties as they fall.
double plain_program(const std::vector<glm::dvec2>& points) {
    const std::size_t n = points.size();
    std::vector<std::vector<double>> value(n, std::vector<double>(n, 0.0));
    std::vector<std::vector<std::size_t>> middle(n, std::vector<std::size_t>(n, 0));
    for (std::size_t width = 2; width < n; ++width) {
        for (std::size_t i = 0; i + width < n; ++i) {
            const std::size_t j = i + width;
            double best = std::numeric_limits<double>::infinity();
            for (std::size_t k = i + 1; k < j; ++k) {
                const double sum = value[i][k] + value[k][j];
                if (sum < best) best = sum, middle[i][j] = k;
            }
            const glm::dvec2 d = points[i] - points[j];
            value[i][j] = best + (width + 1 == n ? 0.0 : std::sqrt(d.x * d.x + d.y * d.y));
        }
    }
    benchmark::DoNotOptimize(middle.data());
    return value[0][n - 1];
}

void plain(benchmark::State& state) {
    const Polygon polygon = regular(static_cast<std::size_t>(state.range(0)));
    const std::vector<glm::dvec2> points(polygon.points.begin(), polygon.points.end());
    double weight = 0.0;
    for (auto _ : state) weight = plain_program(points);
    state.counters["weight"] = weight;
}
BENCHMARK(plain)->Arg(8)->Arg(16)->Arg(32)->Arg(64)->Arg(128)->Arg(256)->Arg(512)->Unit(benchmark::kMillisecond);

// Bends of 12 cells, with and without holes.
void contours_12(benchmark::State& state, bench::Contours which) {
    measure(state, bench::noise_contours(which), {});
}
BENCHMARK_CAPTURE(contours_12, one_ring,
                  bench::Contours{.side = 480, .wavelength = 12.0, .level = -0.1, .holes = false})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);
BENCHMARK_CAPTURE(contours_12, small_ring,
                  bench::Contours{.side = 240, .wavelength = 12.0, .level = -0.1, .holes = false})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);
BENCHMARK_CAPTURE(contours_12, holes, bench::Contours{.side = 240, .wavelength = 12.0, .level = -0.5})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);
BENCHMARK_CAPTURE(contours_12, small_holes, bench::Contours{.side = 120, .wavelength = 12.0, .level = -0.5})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

void contours_12_without_work(benchmark::State& state, bench::Contours which) {
    measure(state, bench::noise_contours(which), {.work = 0});
}
BENCHMARK_CAPTURE(contours_12_without_work, one_ring,
                  bench::Contours{.side = 480, .wavelength = 12.0, .level = -0.1, .holes = false})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(contours_12_without_work, holes, bench::Contours{.side = 240, .wavelength = 12.0, .level = -0.5})
    ->Unit(benchmark::kMillisecond);

// All of the file's polygons that our ear clipping takes, so that both do the same work.
const std::vector<Polygon>& valid_polygons(const std::string& name) {
    static std::map<std::string, std::vector<Polygon>> read;
    const auto [found, fresh] = read.try_emplace(name);
    if (fresh) {
        for (Polygon& p : bench::read_poly_file(kFolder + name, ~std::size_t{0}))
            if (triangulate::triangulate(p, {.method = Method::ear})) found->second.push_back(std::move(p));
    }
    return found->second;
}

void report_vertices(benchmark::State& state, const std::vector<Polygon>& polygons) {
    std::size_t vertices = 0;
    for (const Polygon& p : polygons) vertices += p.points.size();
    state.counters["us_per_vertex"] =
        benchmark::Counter(static_cast<double>(vertices) * static_cast<double>(state.iterations()) * 1e-6,
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void ear_on_file(benchmark::State& state, const char* name) {
    const auto& polygons = valid_polygons(name);
    triangulate::Triangulator triangulator;
    triangulate::Triangulation result;
    for (auto _ : state)
        for (const Polygon& p : polygons) (void)triangulator.triangulate(p, {.method = Method::ear}, result);
    report_vertices(state, polygons);
}
BENCHMARK_CAPTURE(ear_on_file, glyphs, "glyphs.poly")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ear_on_file, doom, "doom.poly")->Unit(benchmark::kMillisecond);

#if defined(CROFTON_HAVE_EARCUT)
using EarcutRings = std::vector<std::vector<std::array<double, 2>>>;

EarcutRings earcut_rings(const Polygon& polygon) {
    EarcutRings rings;
    for (std::size_t r = 0; r < polygon.ring_count(); ++r) {
        rings.emplace_back();
        for (const auto& p : polygon.ring(r)) rings.back().push_back({p.x, p.y});
    }
    return rings;
}

void earcut_on(benchmark::State& state, const std::vector<Polygon>& polygons) {
    std::vector<EarcutRings> rings;
    for (const Polygon& p : polygons) rings.push_back(earcut_rings(p));
    mapbox::detail::Earcut<std::uint32_t> earcut;
    for (auto _ : state) {
        for (const EarcutRings& r : rings) {
            earcut(r);
            benchmark::DoNotOptimize(earcut.indices.data());
        }
    }
    report_vertices(state, polygons);
}
void earcut_on_file(benchmark::State& state, const char* name) {
    earcut_on(state, valid_polygons(name));
}
void earcut_on_ring(benchmark::State& state, Polygon (*make)(std::size_t)) {
    earcut_on(state, {make(static_cast<std::size_t>(state.range(0)))});
}
BENCHMARK_CAPTURE(earcut_on_file, glyphs, "glyphs.poly")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(earcut_on_file, doom, "doom.poly")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(earcut_on_ring, strip, strip)->Arg(1000)->Arg(8000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(earcut_on_ring, ribbon, ribbon)->Arg(1000)->Arg(8000)->Unit(benchmark::kMillisecond);
#endif

}  // namespace
