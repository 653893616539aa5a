// SPDX-License-Identifier: MIT
// One view of a list, beside the plainest loop over AABBs. Compare within one run.
#include <benchmark/benchmark.h>

#include <crofton/boxtree/box_tree.hpp>
#include <crofton/cull/bound_set.hpp>

#include "cull_inputs.hpp"

namespace {

using namespace crofton;
using bench::boxes_of, bench::report;

// Every box against the view; `ids` lists the visible ones besides.
void flat_cull(benchmark::State& state, cull::CullMode mode, bool ids) {
    const auto& boxes = boxes_of(state.range(0));
    const cull::View view = bench::view_of_share(boxes, 0.2);
    cull::BoxSet set;
    set.assign(boxes);
    cull::VerdictBits verdicts;
    std::vector<cull::ItemId> list(boxes.size() + 16);
    std::size_t visible = 0;
    for (auto _ : state) {
        cull::find_visible(set, boxes, view, verdicts, mode);
        if (ids) visible = cull::list_bits(verdicts.visible, list);
        benchmark::DoNotOptimize(verdicts.visible.data());
        benchmark::DoNotOptimize(list.data());
    }
    report(state, visible);
    state.counters["exact_tests"] = static_cast<double>(verdicts.statistics.exact_tests);
}
BENCHMARK_CAPTURE(flat_cull, conservative, cull::CullMode::conservative, false)->Arg(10000)->Arg(1000000);
BENCHMARK_CAPTURE(flat_cull, exact, cull::CullMode::exact, false)->Arg(10000)->Arg(1000000);
BENCHMARK_CAPTURE(flat_cull, exact_ids, cull::CullMode::exact, true)->Arg(10000)->Arg(1000000);

void flat_cull_cold(benchmark::State& state) {
    const auto& boxes = boxes_of(state.range(0));
    const cull::View view = bench::view_of_share(boxes, 0.2);
    cull::BoxSet set;
    set.assign(boxes);
    cull::VerdictBits verdicts;
    bench::time_cold(state, [&] { cull::find_visible(set, boxes, view, verdicts); });
    report(state, 0);
}
BENCHMARK(flat_cull_cold)->Arg(10000)->Arg(1000000)->UseManualTime()->Iterations(bench::kColdIterations);

// What a list must read, and nothing else: eight bytes a box, summed.
void read_rows(benchmark::State& state) {
    cull::BoxSet set;
    set.assign(boxes_of(state.range(0)));
    const auto* words = reinterpret_cast<const std::uint64_t*>(set.rows().data());
    const std::size_t count = set.size();
    for (auto _ : state) {
        std::uint64_t sums[8] = {};
        for (std::size_t i = 0; i + 8 <= count; i += 8)
            for (std::size_t k = 0; k < 8; ++k) sums[k] += words[i + k];
        benchmark::DoNotOptimize(sums);
    }
    report(state, 0);
}
BENCHMARK(read_rows)->Arg(1000000);

// Every fifth bit of a million, as ids.
void list_ids(benchmark::State& state) {
    std::vector<std::uint64_t> bits(15625);
    for (std::size_t i = 0; i < 64 * bits.size(); i += 5) bits[i / 64] |= std::uint64_t{1} << (i % 64);
    std::vector<cull::ItemId> ids(200000 + 16);
    for (auto _ : state) {
        benchmark::DoNotOptimize(cull::list_bits(bits, ids));
        benchmark::DoNotOptimize(ids.data());
    }
}
BENCHMARK(list_ids)->Unit(benchmark::kMicrosecond);

// Every bound of a prepared list against the view.
template <class Bound>
void flat_bounds(benchmark::State& state, const std::vector<Bound>& bounds) {
    const cull::View view = bench::view_of_share(boxes_of(state.range(0)), 0.2);
    cull::BoundSet<Bound> set;
    set.assign(bounds);
    cull::VerdictBits verdicts;
    for (auto _ : state) {
        cull::find_visible(set, bounds, view, verdicts);
        benchmark::DoNotOptimize(verdicts.visible.data());
    }
    report(state, 0);
    state.counters["exact_tests"] = static_cast<double>(verdicts.statistics.exact_tests);
}
// Few boxes: unprepared, prepared as a list, and in a tree.
void few_boxes(benchmark::State& state) {
    const auto& boxes = boxes_of(state.range(0));
    const cull::View view = bench::view_of_share(boxes, 0.2);
    cull::VisibleSet visible;
    for (auto _ : state) {
        cull::find_visible(boxes, {}, view, visible);
        benchmark::DoNotOptimize(visible.ids().data());
    }
    report(state, visible.size());
}
void few_boxes_cold(benchmark::State& state) {
    const auto& boxes = boxes_of(state.range(0));
    const cull::View view = bench::view_of_share(boxes, 0.2);
    cull::VisibleSet visible;
    bench::time_cold(state, [&] { cull::find_visible(boxes, {}, view, visible); });
    report(state, visible.size());
}
void few_boxes_list(benchmark::State& state) {
    flat_bounds(state, boxes_of(state.range(0)));
}
void few_boxes_tree(benchmark::State& state) {
    const boxtree::BoxTree& tree = bench::tree_of(state.range(0));
    const cull::View view = bench::view_of_share(boxes_of(state.range(0)), 0.2);
    cull::VisibleSet visible;
    for (auto _ : state) {
        cull::find_visible(tree, view, visible, {cull::CullMode::exact, cull::ResultOrder::tree});
        benchmark::DoNotOptimize(visible.ids().data());
    }
    report(state, visible.size());
}
BENCHMARK(few_boxes)->Arg(20)->Arg(100)->Arg(1000)->Arg(100000);
BENCHMARK(few_boxes_cold)
    ->Arg(20)
    ->Arg(100)
    ->Arg(1000)
    ->Arg(100000)
    ->UseManualTime()
    ->Iterations(bench::kColdIterations);
BENCHMARK(flat_cull_cold)
    ->Name("few_boxes_list_cold")
    ->Arg(20)
    ->Arg(100)
    ->Arg(1000)
    ->UseManualTime()
    ->Iterations(bench::kColdIterations);
BENCHMARK(few_boxes_list)->Arg(20)->Arg(100)->Arg(1000);
BENCHMARK(few_boxes_tree)->Arg(20)->Arg(100)->Arg(1000);

// The same for axis-aligned boxes and for spheres around the boxes.
void flat_cull_aabbs(benchmark::State& state) {
    std::vector<Aabb> bounds;
    for (const Obb& box : boxes_of(state.range(0))) bounds.push_back(aabb_of(box));
    flat_bounds(state, bounds);
}
void flat_cull_spheres(benchmark::State& state) {
    std::vector<Sphere> bounds;
    for (const Obb& box : boxes_of(state.range(0)))
        bounds.push_back({box.center, glm::length(glm::dvec3(box.half_extents))});
    flat_bounds(state, bounds);
}
BENCHMARK(flat_cull_aabbs)->Arg(10000)->Arg(1000000);
BENCHMARK(flat_cull_spheres)->Arg(10000)->Arg(1000000);

// Axis-aligned boxes around ours, in float arrays, each against the six planes by its nearest corner: what a compiler
// makes of the plainest loop. Writes one byte per box.
void aabb_loop(benchmark::State& state) {
    const auto& boxes = boxes_of(state.range(0));
    const cull::View view = bench::view_of_share(boxes, 0.2);
    const std::size_t n = boxes.size();
    std::vector<float> center[3], half[3];
    for (int j = 0; j < 3; ++j) center[j].resize(n), half[j].resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        const Aabb box = aabb_of(boxes[i]);
        for (int j = 0; j < 3; ++j) {
            center[j][i] = static_cast<float>(box.center()[j] - view.frustum.origin[j]);
            half[j][i] = static_cast<float>(box.half_extents()[j]);
        }
    }
    std::vector<unsigned char> seen(n);
    for (auto _ : state) {
        float p[6][7];
        for (unsigned k = 0; k < 6; ++k) {
            const Plane& plane = view.frustum.planes[k];
            for (int j = 0; j < 3; ++j) {
                p[k][j] = static_cast<float>(plane.normal[j]);
                p[k][4 + j] = std::fabs(p[k][j]);
            }
            p[k][3] = static_cast<float>(plane.offset);
        }
        const float *cx = center[0].data(), *cy = center[1].data(), *cz = center[2].data();
        const float *hx = half[0].data(), *hy = half[1].data(), *hz = half[2].data();
        unsigned char* out = seen.data();
        for (std::size_t i = 0; i < n; ++i) {
            float least = 1e30f;
            for (unsigned k = 0; k < 6; ++k) {
                const float top = p[k][0] * cx[i] + p[k][1] * cy[i] + p[k][2] * cz[i] + p[k][3] + p[k][4] * hx[i] +
                                  p[k][5] * hy[i] + p[k][6] * hz[i];
                least = top < least ? top : least;
            }
            out[i] = least >= 0.0f;
        }
        benchmark::DoNotOptimize(seen.data());
        benchmark::ClobberMemory();
    }
    std::size_t visible = 0;
    for (const unsigned char s : seen) visible += s;
    report(state, visible);
}
BENCHMARK(aabb_loop)->Arg(20)->Arg(100)->Arg(1000)->Arg(10000)->Arg(1000000);

}  // namespace
