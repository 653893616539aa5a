// Several views in one pass beside one query each.
#include <benchmark/benchmark.h>

#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/many_views.hpp>

#include "cull_inputs.hpp"

namespace {

using namespace crofton;
using bench::boxes_of, bench::tree_of;

// Views all around the middle of the crowd, four to a round like a cube's sides, rounds turned against each other.
std::vector<cull::View> views_around(std::int64_t boxes, std::int64_t count) {
    std::vector<cull::View> views;
    for (std::int64_t v = 0; v < count; ++v) {
        Camera camera;
        const double angle = 1.5707963 * static_cast<double>(v % 4) + 0.15 * static_cast<double>(v / 4);
        camera.position = std::cbrt(static_cast<double>(boxes)) * glm::dvec3(0.5);
        camera.forward = {std::cos(angle), 0.05, std::sin(angle)};
        camera.fov_y = 1.5708;
        camera.aspect = 1.0;
        views.push_back({*frustum_of(camera)});
    }
    return views;
}

// Many views of a list in one pass beside one query each.
void flat_views(benchmark::State& state, bool one_pass) {
    const auto& boxes = boxes_of(state.range(0));
    const std::vector<cull::View> views = views_around(state.range(0), state.range(1));
    cull::BoxSet set;
    set.assign(boxes);
    std::vector<std::uint32_t> masks(boxes.size());
    cull::VerdictBits verdicts;
    for (auto _ : state) {
        if (one_pass)
            cull::cull(set, boxes, {}, views, masks);
        else
            for (const cull::View& view : views) cull::cull(set, boxes, view, verdicts);
        benchmark::DoNotOptimize(masks.data());
    }
}
BENCHMARK_CAPTURE(flat_views, one_pass, true)->Args({1000000, 4})->Args({1000000, 32})->Args({10000000, 4});
BENCHMARK_CAPTURE(flat_views, one_by_one, false)->Args({1000000, 4})->Args({1000000, 32})->Args({10000000, 4});

// Four cascades or cube faces: one pass beside one query each.
void many_views(benchmark::State& state, bool one_pass) {
    const tree::BoxTree& tree = tree_of(state.range(0));
    const std::vector<cull::View> views = views_around(state.range(0), 4);
    cull::ManyVisible many;
    cull::VisibleSet one;
    for (auto _ : state) {
        if (one_pass)
            cull::cull(tree, views, many);
        else
            for (const cull::View& view : views) cull::cull(tree, view, one, {cull::Mode::exact, cull::Order::tree});
    }
}
BENCHMARK_CAPTURE(many_views, one_pass, true)->Arg(100000)->Arg(1000000);
BENCHMARK_CAPTURE(many_views, one_by_one, false)->Arg(100000)->Arg(1000000);

}  // namespace
