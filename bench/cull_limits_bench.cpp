// SPDX-License-Identifier: MIT
// What draw limits cost a query, and save it.
#include <benchmark/benchmark.h>

#include <crofton/boxtree/box_tree.hpp>
#include <crofton/cull/cull.hpp>
#include <vector>

#include "cull_inputs.hpp"

namespace {

using namespace crofton;
using bench::boxes_of, bench::tree_of;

enum class Limits { none, never, layers, size };

// `never` drops nothing, `layers` what is farther than a quarter of the crowd's side, `size` what is below 24 of 1080
// pixels.
struct LimitedQuery {
    cull::View view;
    std::vector<float> distances;
    cull::DrawLimits limits;

    LimitedQuery(std::int64_t count, Limits which) : view(bench::view_of_share(boxes_of(count), 0.2)) {
        const auto side = static_cast<float>(std::cbrt(static_cast<double>(count)));
        limits.eye = view.frustum.origin;
        distances.assign(32, which == Limits::never ? 1e6f : 0.25f * side);
        if (which == Limits::never || which == Limits::layers) limits.layer_distances = distances;
        if (which == Limits::size)
            limits.max_distance_in_radii = cull::limits_of(Camera{}, 1080.0, 24.0).value().max_distance_in_radii;
    }
};

void limited_tree(benchmark::State& state, Limits which) {
    const boxtree::BoxTree& tree = tree_of(state.range(0));
    const LimitedQuery query(state.range(0), which);
    cull::VisibleSet visible;
    const cull::CullOptions options{cull::CullMode::exact, cull::ResultOrder::tree,
                                    which == Limits::none ? nullptr : &query.limits};
    for (auto _ : state) cull::find_visible(tree, query.view, visible, options);
    bench::report(state, visible.size());
}
void limited_boxes(benchmark::State& state, Limits which) {
    const std::vector<Obb>& boxes = boxes_of(state.range(0));
    const LimitedQuery query(state.range(0), which);
    cull::VisibleSet visible;
    const cull::CullOptions options{.limits = which == Limits::none ? nullptr : &query.limits};
    for (auto _ : state) cull::find_visible(boxes, {}, query.view, visible, options);
    bench::report(state, visible.size());
}
BENCHMARK_CAPTURE(limited_tree, none, Limits::none)->Arg(100'000)->Arg(1'000'000);
BENCHMARK_CAPTURE(limited_tree, never, Limits::never)->Arg(100'000)->Arg(1'000'000);
BENCHMARK_CAPTURE(limited_tree, layers, Limits::layers)->Arg(100'000)->Arg(1'000'000);
BENCHMARK_CAPTURE(limited_tree, size, Limits::size)->Arg(100'000)->Arg(1'000'000);
BENCHMARK_CAPTURE(limited_boxes, none, Limits::none)->Arg(100'000);
BENCHMARK_CAPTURE(limited_boxes, never, Limits::never)->Arg(100'000);
BENCHMARK_CAPTURE(limited_boxes, layers, Limits::layers)->Arg(100'000);
BENCHMARK_CAPTURE(limited_boxes, size, Limits::size)->Arg(100'000);

}  // namespace
