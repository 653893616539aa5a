// SPDX-License-Identifier: MIT
// Several views in one pass beside one query each.
#include <benchmark/benchmark.h>

#include <crofton/boxtree/box_tree.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <utility>

#include "cull_inputs.hpp"

namespace {

using namespace crofton;
using bench::boxes_of, bench::tree_of;

// From the middle of the crowd: two eyes that see nearly the same, a cube's six sides, or views all around, four to a
// round, rounds turned against each other.
std::vector<cull::View> views_of(std::int64_t boxes, std::int64_t count) {
    const double side = std::cbrt(static_cast<double>(boxes));
    std::vector<cull::View> views;
    for (std::int64_t v = 0; v < count; ++v) {
        Camera camera;
        camera.position = side * glm::dvec3(0.5);
        const double angle = 1.5707963 * static_cast<double>(v % 4) + 0.15 * static_cast<double>(v / 4);
        camera.forward = {std::cos(angle), 0.05, std::sin(angle)};
        camera.fov_y = 1.5707963;
        camera.aspect = 1.0;
        if (count == 2) {
            camera.forward = {1.0, 0.05, 0.1};
            camera.position.z += 0.065 * static_cast<double>(v);
        }
        if (count == 6) {
            camera.forward = camera.up = glm::dvec3(0.0);
            camera.forward[static_cast<int>(v / 2)] = v % 2 ? 1.0 : -1.0;
            camera.up[static_cast<int>(v / 2 + 1) % 3] = 1.0;
        }
        views.push_back({*frustum_of(camera)});
    }
    return views;
}

void sizes_and_views(benchmark::internal::Benchmark* benchmark) {
    for (const std::int64_t count : {10'000, 100'000, 1'000'000, 10'000'000})
        for (const std::int64_t views : {2, 4, 6, 32}) benchmark->Args({count, views});
}

// Views of a list in one pass beside one query each, whose answers are kept as well.
void flat_views(benchmark::State& state, bool one_pass) {
    const auto& boxes = boxes_of(state.range(0));
    const std::vector<cull::View> views = views_of(state.range(0), state.range(1));
    cull::BoxSet set;
    set.assign(boxes);
    std::vector<std::uint32_t> masks(boxes.size());
    std::vector<cull::VerdictBits> verdicts(views.size());
    const auto ask = [&] {
        if (one_pass)
            (void)cull::find_visible(set, boxes, {}, views, masks);
        else
            for (std::size_t v = 0; v < views.size(); ++v) cull::find_visible(set, boxes, views[v], verdicts[v]);
        benchmark::DoNotOptimize(masks.data());
    };
    ask();  // memory is taken once
    for (auto _ : state) ask();
}
BENCHMARK_CAPTURE(flat_views, one_pass, true)->Apply(sizes_and_views);
BENCHMARK_CAPTURE(flat_views, one_by_one, false)->Apply(sizes_and_views);

// The same of a tree. `merged`: one query each, and the masks of those that a view sees made from the answers, as one
// pass gives them.
enum class Way { one_pass, one_by_one, merged };

class Merge {
  public:
    explicit Merge(std::size_t items) : masks_(items), ids_(items), listed_(items) {}

    std::size_t operator()(const std::vector<cull::VisibleSet>& views) {
        std::size_t count = 0;
        for (std::size_t v = 0; v < views.size(); ++v)
            for (const cull::ItemId id : views[v].ids()) {
                ids_[count] = id;
                count += masks_[id] == 0;
                masks_[id] |= 1u << v;
            }
        for (std::size_t i = 0; i < count; ++i) listed_[i] = std::exchange(masks_[ids_[i]], 0);
        return count;
    }

  private:
    std::vector<std::uint32_t> masks_;
    std::vector<cull::ItemId> ids_;
    std::vector<std::uint32_t> listed_;
};

void tree_views(benchmark::State& state, Way way) {
    const boxtree::BoxTree& tree = tree_of(state.range(0));
    const std::vector<cull::View> views = views_of(state.range(0), state.range(1));
    cull::MaskedVisibleSet many;
    std::vector<cull::VisibleSet> single(views.size());
    Merge merge(tree.boxes().size() + 1);
    const auto ask = [&] {
        if (way == Way::one_pass) return (void)cull::find_visible(tree, views, many);
        for (std::size_t v = 0; v < views.size(); ++v)
            cull::find_visible(tree, views[v], single[v], {cull::CullMode::exact, cull::ResultOrder::tree});
        if (way == Way::merged) benchmark::DoNotOptimize(merge(single));
    };
    ask();
    for (auto _ : state) ask();
}
BENCHMARK_CAPTURE(tree_views, one_pass, Way::one_pass)->Apply(sizes_and_views);
BENCHMARK_CAPTURE(tree_views, one_by_one, Way::one_by_one)->Apply(sizes_and_views);
BENCHMARK_CAPTURE(tree_views, merged, Way::merged)->Apply(sizes_and_views);

}  // namespace
