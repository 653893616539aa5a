// SPDX-License-Identifier: MIT
// Shadow casters of a crowd: what is in the shadow volume, and what could fall on something seen.
#include <benchmark/benchmark.h>

#include <crofton/boxtree/box_tree.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/cull/lights.hpp>
#include <vector>

#include "cull_inputs.hpp"

namespace {

using namespace crofton;

void shadow_casters(benchmark::State& state, bool is_sun) {
    const auto count = state.range(0);
    const boxtree::BoxTree& tree = bench::tree_of(count);
    const cull::View view = bench::view_of_share(bench::boxes_of(count), 0.02);
    const glm::dvec3 toward(0.3, 1.0, 0.2);
    const Sphere lamp{view.frustum.origin + glm::dvec3(0.0, 5.0, 0.0), 20.0};
    cull::VisibleSet visible, candidates;
    cull::CasterFilter receivers;
    std::vector<Obb> seen, boxes;
    Vector<std::uint32_t> casters;
    const auto query = [&] {
        cull::find_visible(tree, view, visible);
        seen.clear();
        for (const cull::ItemId id : visible.ids()) seen.push_back(tree.boxes()[id]);
        const Frustum volume = is_sun ? cull::shadow_volume(view.frustum, toward).value()
                                      : cull::shadow_volume_of_point(view.frustum, lamp.center).value();
        cull::find_visible(tree, {volume}, candidates);
        boxes.clear();
        for (const cull::ItemId id : candidates.ids()) boxes.push_back(tree.boxes()[id]);
    };
    query();
    for (auto _ : state) {
        (void)(is_sun ? receivers.set_sun(view.frustum, seen, toward) : receivers.set_point(view.frustum, seen, lamp));
        receivers.find_casters(boxes, casters);
    }
    state.counters["receivers"] = static_cast<double>(seen.size());
    state.counters["in_volume"] = static_cast<double>(boxes.size());
    state.counters["wanted"] = static_cast<double>(casters.size());
}
BENCHMARK_CAPTURE(shadow_casters, sun, true)->Arg(10'000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(shadow_casters, point, false)->Arg(10'000)->Unit(benchmark::kMillisecond);

}  // namespace
