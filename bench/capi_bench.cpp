// SPDX-License-Identifier: MIT
// What the C API adds to a query: the same small queries from C++ and through C, in one run.
//   bench_capi --benchmark_min_time=0.5 --benchmark_repetitions=9 --benchmark_enable_random_interleaving=true
#include <benchmark/benchmark.h>
#include <crofton/capi/scene.h>
#include <crofton/boxtree/box_tree.hpp>

#include <crofton/collide/narrow_phase.hpp>
#include <crofton/cull/cull.hpp>
#include <vector>

namespace {

// Few boxes: what is common to both ways must not hide the difference.
std::vector<crofton::Obb> make_boxes(std::int64_t count) {
    std::vector<crofton::Obb> boxes(static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        boxes[i].center = {static_cast<double>(i % 8) * 3.0 - 12.0, 0.0, -static_cast<double>(i) * 0.5};
        boxes[i].half_extents = glm::vec3(1.0f);
    }
    return boxes;
}

void cull_cpp(benchmark::State& state) {
    const auto tree = crofton::boxtree::BoxTree::build(make_boxes(state.range(0))).value();
    const crofton::cull::View view{.frustum = crofton::frustum_of(crofton::Camera{}).value()};
    crofton::cull::VisibleSet visible;
    for (auto _ : state) {
        crofton::cull::find_visible(tree, view, visible);
        benchmark::DoNotOptimize(visible.ids().data());
    }
}
BENCHMARK(cull_cpp)->Arg(1)->Arg(16)->Arg(256);

void cull_c(benchmark::State& state) {
    const auto boxes = make_boxes(state.range(0));
    const crofton_camera camera = crofton_default_camera();
    crofton_frustum frustum{};
    frustum.size = sizeof frustum;
    crofton_view_request request = crofton_default_view_request();
    request.volume = &frustum;
    crofton_tree* tree = nullptr;
    crofton_view_result* visible = nullptr;
    if (crofton_frustum_from_camera(&camera, &frustum) != CROFTON_OK ||
        crofton_tree_create(reinterpret_cast<const crofton_box*>(boxes.data()), nullptr, boxes.size(), nullptr,
                            &tree) != CROFTON_OK ||
        crofton_view_result_create(&visible) != CROFTON_OK)
        return state.SkipWithError(crofton_last_error());
    for (auto _ : state) {
        const uint32_t* ids = nullptr;
        size_t count = 0;
        crofton_tree_view(tree, &request, nullptr, visible);
        crofton_view_result_ids(visible, &ids, &count, nullptr, nullptr);
        benchmark::DoNotOptimize(ids);
    }
    crofton_view_result_destroy(visible);
    crofton_tree_destroy(tree);
}
BENCHMARK(cull_c)->Arg(1)->Arg(16)->Arg(256);

void boxes_meet_cpp(benchmark::State& state) {
    const auto boxes = make_boxes(2);
    for (auto _ : state) benchmark::DoNotOptimize(crofton::collide::intersects(boxes[0], boxes[1]));
}
BENCHMARK(boxes_meet_cpp);

void boxes_meet_c(benchmark::State& state) {
    const auto boxes = make_boxes(2);
    const auto* c = reinterpret_cast<const crofton_box*>(boxes.data());
    for (auto _ : state) {
        int meet = 0;
        crofton_boxes_meet(&c[0], &c[1], &meet);
        benchmark::DoNotOptimize(meet);
    }
}
BENCHMARK(boxes_meet_c);

}  // namespace
