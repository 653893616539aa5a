// SPDX-License-Identifier: MIT
// How the cost of occlusion grows: occlude_growth [--target=NAME] [LARGEST] prints CSV. First with the number of
// occluders, 10 to 10,000, of which the best 256 are chosen; then with that of objects, 1,000 to LARGEST (10^7).
#include <algorithm>
#include <chrono>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <cstdio>
#include <cstdlib>

#include "occlude_town.hpp"
#include "simd_target.hpp"

namespace {

using namespace crofton;

// Milliseconds: the least of repetitions that last a twentieth of a second together, at least three of them.
template <class Work>
double least_time(const Work& work) {
    using Clock = std::chrono::steady_clock;
    double least = 1e30, total = 0.0;
    for (int n = 0; n < 3 || total < 50.0; ++n) {
        const auto start = Clock::now();
        work();
        const double time = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
        least = std::min(least, time);
        total += time;
    }
    return least;
}

// From a street in the middle of the town.
Camera street_view(const bench::OcclusionTown& town) {
    Camera camera = town.cameras[0];
    camera.position = {12.0, 1.7, 0.0};
    camera.forward.y = 0.0;
    return camera;
}

void measure_town(const char* what, std::size_t houses, std::size_t objects) {
    const bench::OcclusionTown town = bench::occlusion_town(7, houses, objects, 1.7);
    const Camera camera = street_view(town);
    const auto view = *occlude::occlusion_view_of(camera);
    occlude::OccluderSet set;
    occlude::OccluderCandidates candidates;
    Aabb bounds;
    for (const Obb& house : town.houses) {
        (void)set.place(house);
        (void)candidates.add(occlude::candidate_of(house));
        bounds.include(aabb_of(house));
    }
    const auto tree = *boxtree::BoxTree::build(town.objects);
    auto all = *occlude::OcclusionBuffer::create({480, 270}), best = *occlude::OcclusionBuffer::create({480, 270});
    occlude::OccluderChoice choice;
    occlude::VisibleSet visible;
    cull::VisibleSet in_frustum;
    const double choose = least_time(
        [&] { occlude::choose_occluders(candidates, view, {.max_occluders = 256, .objects = bounds}, choice); });
    const double draw = least_time([&] { best.draw(set, choice.ids, view); });
    const double draw_all = least_time([&] { all.draw(set, view); });
    const double without = least_time([&] { cull::find_visible(tree, {view.frustum}, in_frustum); });
    occlude::find_visible(tree, all, visible);
    const std::size_t visible_with_all = visible.size();
    const double with = least_time([&] { occlude::find_visible(tree, best, visible); });
    std::printf("%s,%zu,%zu,%zu,%zu,%zu,%zu,%.4f,%.4f,%.4f,%.4f,%.4f\n", what, houses, objects, choice.ids.size(),
                in_frustum.size(), visible.size(), visible_with_all, choose, draw, draw_all, with, without);
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    if (!crofton::bench::take_target_option(argc, argv)) return 1;
    const double largest = argc > 1 ? std::atof(argv[1]) : 1e7;
    std::printf("# instruction set %s, one thread, buffer 480 x 270, milliseconds\n", crofton::bench::target_in_use());
    std::puts(
        "growth,occluders,objects,chosen,in_frustum,visible,visible_with_all_occluders,choose,draw,draw_all,query,"
        "query_without_occlusion");
    for (const std::size_t houses : {10u, 30u, 100u, 300u, 1000u, 3000u, 10'000u})
        measure_town("occluders", houses, 20'000);
    for (double objects = 1e3; objects <= 1.01 * largest; objects *= std::sqrt(10.0))
        measure_town("objects", 4096, static_cast<std::size_t>(std::llround(objects)));
    return 0;
}
