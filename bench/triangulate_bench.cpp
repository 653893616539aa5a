// SPDX-License-Identifier: MIT
// Microseconds a vertex of the three methods, on real polygons and on contours of noise; CGAL's constrained Delaunay
// triangulation beside ours where it is installed.
#include <benchmark/benchmark.h>

#include <crofton/triangulate/triangulate.hpp>
#include <map>

#include "triangulate_inputs.hpp"

#if defined(CROFTON_HAVE_CGAL)
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#endif

using namespace crofton;
using triangulate::Method;

namespace {

const std::string kFolder = std::string(CROFTON_SHARED_DATA) + "/polygons/";

const std::vector<Polygon>& file(const std::string& name, std::size_t most) {
    static std::map<std::pair<std::string, std::size_t>, std::vector<Polygon>> read;
    const auto [found, fresh] = read.try_emplace({name, most});
    if (fresh) found->second = bench::read_poly_file(kFolder + name, most);
    return found->second;
}

void measure(benchmark::State& state, const std::vector<Polygon>& polygons, Method method) {
    if (polygons.empty()) return state.SkipWithError("the file is absent");
    triangulate::Triangulator triangulator;
    triangulate::Triangulation result;
    std::size_t vertices = 0, optimal = 0, done = 0;
    double weight = 0.0;
    for (auto _ : state) {
        weight = 0.0;
        vertices = optimal = done = 0;
        for (const Polygon& polygon : polygons) {
            vertices += polygon.points.size();
            if (!triangulator.triangulate(polygon, {.method = method, .work = 2'000'000'000}, result)) continue;
            weight += result.weight;
            optimal += result.optimal;
            ++done;
        }
    }
    state.counters["us_per_vertex"] =
        benchmark::Counter(static_cast<double>(vertices) * static_cast<double>(state.iterations()) * 1e-6,
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    state.counters["weight"] = weight;
    state.counters["vertices"] = static_cast<double>(vertices);
    state.counters["proven"] = done == 0 ? 0.0 : static_cast<double>(optimal) / static_cast<double>(done);
}

void small_polygons(benchmark::State& state, const char* name, Method method) {
    measure(state, file(name, 64), method);
}
void all_polygons(benchmark::State& state, const char* name, Method method) {
    measure(state, file(name, ~std::size_t{0}), method);
}

// side, holes
void contours(benchmark::State& state, Method method) {
    const std::vector<Polygon> polygons{bench::noise_contours(
        {.side = static_cast<std::uint32_t>(state.range(0)), .level = -0.1, .holes = state.range(1) != 0})};
    measure(state, polygons, method);
    state.counters["holes"] = static_cast<double>(polygons[0].ring_count() - 1);
}

#define CROFTON_METHODS(function, name, file_name)                                                            \
    BENCHMARK_CAPTURE(function, name##_ear, file_name, Method::ear)->Unit(benchmark::kMillisecond);           \
    BENCHMARK_CAPTURE(function, name##_delaunay, file_name, Method::delaunay)->Unit(benchmark::kMillisecond); \
    BENCHMARK_CAPTURE(function, name##_minimum_weight, file_name, Method::minimum_weight)->Unit(benchmark::kMillisecond)

CROFTON_METHODS(small_polygons, doom_64, "doom.poly");
CROFTON_METHODS(small_polygons, glyphs_64, "glyphs.poly");
CROFTON_METHODS(all_polygons, counties10, "counties10.poly");
BENCHMARK_CAPTURE(all_polygons, fixtures_delaunay, "fixtures.poly", Method::delaunay)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(contours, delaunay, Method::delaunay)
    ->ArgsProduct({{60, 120, 240, 480}, {0, 1}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(contours, minimum_weight, Method::minimum_weight)
    ->ArgsProduct({{60, 120, 240}, {0, 1}})
    ->Unit(benchmark::kMillisecond);

// 124,400 vertices with 2,442 holes, and 4,332 without a hole.
void large_contours(benchmark::State& state, bench::Contours which) {
    measure(state, {bench::noise_contours(which)}, Method::minimum_weight);
}
BENCHMARK_CAPTURE(large_contours, many_holes, bench::Contours{.side = 677, .wavelength = 4.0, .level = -0.2})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);
BENCHMARK_CAPTURE(large_contours, no_hole,
                  bench::Contours{.side = 240, .wavelength = 12.0, .level = -0.1, .holes = false})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(3);

#if defined(CROFTON_HAVE_CGAL)
// Constraints only, no marking of what lies inside and no check of the rings.
void cgal_delaunay(benchmark::State& state, const char* name, std::size_t most) {
    using Triangulation =
        CGAL::Constrained_Delaunay_triangulation_2<CGAL::Exact_predicates_inexact_constructions_kernel>;
    const auto& polygons = file(name, most);
    if (polygons.empty()) return state.SkipWithError("the file is absent");
    triangulate::Triangulator triangulator;
    triangulate::Triangulation ours;
    // Those that cross themselves would need constructed points: left out.
    std::vector<Triangulation::Point> points;
    std::size_t vertices = 0;
    for (auto _ : state) {
        vertices = 0;
        for (const Polygon& polygon : polygons) {
            state.PauseTiming();
            const bool valid = triangulator.triangulate(polygon, {.method = Method::delaunay}, ours).has_value();
            state.ResumeTiming();
            if (!valid) continue;
            Triangulation triangulation;
            vertices += polygon.points.size();
            for (std::size_t r = 0; r < polygon.ring_count(); ++r) {
                points.clear();
                for (const auto& p : polygon.ring(r)) points.emplace_back(p.x, p.y);
                triangulation.insert_constraint(points.begin(), points.end(), true);
            }
            benchmark::DoNotOptimize(triangulation.number_of_faces());
        }
    }
    state.counters["us_per_vertex"] =
        benchmark::Counter(static_cast<double>(vertices) * static_cast<double>(state.iterations()) * 1e-6,
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK_CAPTURE(cgal_delaunay, doom_64, "doom.poly", std::size_t{64})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(cgal_delaunay, counties10, "counties10.poly", ~std::size_t{0})->Unit(benchmark::kMillisecond);
#endif

}  // namespace
