// SPDX-License-Identifier: MIT
// Times of the measures: exact integration in the plane, bounds given ancestors, quadrature in space, samplers.
#include <benchmark/benchmark.h>

#include <cmath>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/planar_bounds.hpp>
#include <crofton/study/planar_lines.hpp>
#include <crofton/study/spatial_lines.hpp>
#include <glm/geometric.hpp>
#include <vector>

namespace {

using namespace crofton;
using namespace crofton::sampling;
using namespace crofton::study;

std::vector<PlanarSupport> discs(std::int64_t n) {
    Random random(1);
    std::vector<PlanarSupport> result;
    for (std::int64_t i = 0; i < n; ++i)
        result.emplace_back(Disc{disc_point(random.point<2>()), 2.0 + random.uniform()});
    return result;
}

void lines_hitting_n_discs(benchmark::State& state) {
    const auto figures = discs(state.range(0));
    for (auto _ : state) benchmark::DoNotOptimize(measure_of_lines_hitting_all(figures));
    state.SetComplexityN(state.range(0));
}
BENCHMARK(lines_hitting_n_discs)->RangeMultiplier(4)->Range(16, 1 << 14)->Unit(benchmark::kMicrosecond)->Complexity();

// An object of n hull corners (on an ellipse) under `levels` ancestors.
void optimal_disc_of_n_corners(benchmark::State& state) {
    std::vector<glm::dvec2> points;
    for (std::int64_t i = 0; i < state.range(0); ++i)
        points.push_back(glm::dvec2(1.0, 0.5) *
                         circle_point(static_cast<double>(i) / static_cast<double>(state.range(0))));
    std::vector<PlanarSupport> ancestors;
    Random random(2);
    for (std::int64_t k = 0; k < state.range(1); ++k)
        ancestors.emplace_back(Disc{0.5 * disc_point(random.point<2>()), 1.6});
    const PlanarSupport envelope = lower_envelope(ancestors);
    double evaluations = 0.0;
    for (auto _ : state) evaluations = static_cast<double>(optimal_disc(points, envelope)->evaluations);
    state.counters["evaluations"] = evaluations;
    state.SetComplexityN(state.range(0));
}
BENCHMARK(optimal_disc_of_n_corners)
    ->ArgsProduct({{16, 64, 256, 1024, 4096, 16384}, {1}})
    ->Unit(benchmark::kMicrosecond)
    ->Complexity();
BENCHMARK(optimal_disc_of_n_corners)->ArgsProduct({{256}, {4, 16, 64}})->Unit(benchmark::kMicrosecond);

void optimal_rectangle_of_n_corners(benchmark::State& state) {
    Random random(3);
    std::vector<glm::dvec2> points;
    for (std::int64_t i = 0; i < state.range(0); ++i)
        points.push_back(glm::dvec2(1.0, 0.5) * disc_point(random.point<2>()));
    const PlanarSupport ancestor(Disc{{0.2, 0.1}, 1.4});
    double evaluations = 0.0;
    for (auto _ : state) evaluations = static_cast<double>(optimal_rectangle(points, ancestor)->evaluations);
    state.counters["evaluations"] = evaluations;
}
BENCHMARK(optimal_rectangle_of_n_corners)->Arg(16)->Arg(1024)->Unit(benchmark::kMicrosecond);

std::vector<ConvexBody> three_boxes() {
    std::vector<ConvexBody> bodies;
    Random random(4);
    for (int i = 0; i < 3; ++i) {
        Obb box;
        box.center = 0.2 * ball_point(random.point<3>());
        box.axes = glm::mat3(rotation(random.point<3>()));
        box.half_extents = glm::vec3(1.0f, 0.7f, 0.4f);
        bodies.push_back(ConvexBody::box(box));
    }
    return bodies;
}

// The cells are the argument; the counter is the relative error proved.
void planes_hitting_three_boxes(benchmark::State& state) {
    const auto bodies = three_boxes();
    Enclosure result;
    for (auto _ : state)
        result = *measure_of_planes_hitting_all(
            bodies, {.tolerance = 0.0, .max_cells = static_cast<std::uint64_t>(state.range(0))});
    state.counters["relative_error"] = result.error / result.value;
}
BENCHMARK(planes_hitting_three_boxes)->RangeMultiplier(8)->Range(64, 1 << 15)->Unit(benchmark::kMicrosecond);

void lines_hitting_three_boxes(benchmark::State& state) {
    const auto bodies = three_boxes();
    Enclosure result;
    for (auto _ : state)
        result = *measure_of_lines_hitting_all(
            bodies, {.tolerance = 0.0, .max_cells = static_cast<std::uint64_t>(state.range(0))});
    state.counters["relative_error"] = result.error / result.value;
}
BENCHMARK(lines_hitting_three_boxes)->RangeMultiplier(8)->Range(64, 1 << 15)->Unit(benchmark::kMicrosecond);

template <Line (*kSample)(const Sphere&, const std::array<double, 4>&)>
void line_sampler(benchmark::State& state) {
    Random random(5);
    const Sphere sphere{glm::dvec3(0.0), 1.0};
    for (auto _ : state) benchmark::DoNotOptimize(kSample(sphere, random.point<4>()));
}
BENCHMARK(line_sampler<line_through_two_sphere_points>);
BENCHMARK(line_sampler<line_through_disc>);

void uniform_motion(benchmark::State& state) {
    const UnitPoints points(6, state.range(0) ? Sequence::quasi_random : Sequence::pseudo_random);
    const Aabb box{glm::dvec3(-1.0), glm::dvec3(1.0)};
    std::uint64_t i = 0;
    for (auto _ : state) benchmark::DoNotOptimize(motion(box, points.at<6>(i++)));
}
BENCHMARK(uniform_motion)->Arg(0)->Arg(1);

}  // namespace
