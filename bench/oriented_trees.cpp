// SPDX-License-Identifier: MIT
// What inner bounds along turned axes are worth, by scene: what a tree is expected to save by the criterion, what it
// saves in bounds and boxes tested, and in time; and the limit of that. usage: bench_oriented [--target=NAME] [COUNT]
#include <algorithm>
#include <chrono>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <cstdio>
#include <cstdlib>

#include "simd_target.hpp"
#include "turned_scenes.hpp"

namespace {

using namespace crofton;
using boxtree::Orientation;
using Clock = std::chrono::steady_clock;

constexpr Orientation kKinds[3] = {Orientation::aligned, Orientation::oriented, Orientation::automatic};
constexpr int kViews = 60, kRepetitions = 60;

std::vector<Camera> cameras_in(const std::vector<Obb>& boxes, double depth) {
    Aabb scene;
    for (const Obb& box : boxes) scene.include(box.center);
    std::mt19937_64 random(7);
    const auto number = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    std::vector<Camera> cameras;
    for (int i = 0; i < kViews; ++i) {
        Camera camera;
        for (int j = 0; j < 3; ++j) camera.position[j] = number(scene.min[j], scene.max[j]);
        for (int j = 0; j < 3; ++j) camera.forward[j] = j == 1 ? number(-0.3, 0.3) : number(-1, 1);
        camera.far_distance = depth * glm::length(scene.max - scene.min);
        cameras.push_back(camera);
    }
    return cameras;
}

std::vector<cull::View> views_of(const std::vector<Camera>& cameras) {
    std::vector<cull::View> views;
    for (const Camera& camera : cameras) views.push_back({*frustum_of(camera)});
    return views;
}

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

struct Tree {
    boxtree::BoxTree tree;
    double build_ms = 0.0;
    double perimeters = 0.0;  // of all bounds: visits below the root, up to a factor
    std::size_t turned = 0;

    Tree(const std::vector<Obb>& boxes, Orientation orientation) : tree(*boxtree::BoxTree::build({})) {
        const auto start = Clock::now();
        tree = *boxtree::BoxTree::build(boxes, {.orientation = orientation});
        build_ms = milliseconds_since(start);
        for (const boxtree::Node& node : tree.structure().nodes()) {
            turned += node.axes != 0;
            for (unsigned lane = 0; lane < node.count; ++lane)
                for (unsigned k = 0; k < 3; ++k) perimeters += double{node.unit} * boxtree::half_of(node, lane, k);
        }
    }
};

struct Measured {
    double microseconds = 0.0, tests = 0.0;
};

// Each tree is asked all its views in turn, so that none profits from what another has left in the caches.
void time_views(std::vector<Tree>& trees, const std::vector<cull::View> (&views_of_tree)[3], Measured (&result)[3]) {
    std::vector<double> least[3];
    for (auto& times : least) times.assign(kViews, 1e30);
    cull::VisibleSet visible;
    for (int repetition = 0; repetition < kRepetitions; ++repetition)
        for (int turn = 0; turn < 3; ++turn) {
            const int k = (turn + repetition) % 3;
            const std::vector<cull::View>& views = views_of_tree[k];
            for (std::size_t v = 0; v < views.size(); ++v) {
                const auto start = Clock::now();
                cull::find_visible(trees[static_cast<std::size_t>(k)].tree, views[v], visible,
                                   {cull::CullMode::exact, cull::ResultOrder::tree});
                least[k][v] = std::min(least[k][v], 1e3 * milliseconds_since(start));
                if (repetition == 0)
                    result[k].tests +=
                        static_cast<double>(visible.statistics().nodes_tested + visible.statistics().boxes_tested) /
                        kViews;
            }
        }
    for (int k = 0; k < 3; ++k)
        for (const double time : least[k]) result[k].microseconds += time / kViews;
}

// The most that turning a whole tree can gain: the town at 30° beside the town that stands along the axes, which is
// asked by the same views turned back.
void print_limit(std::uint32_t count) {
    const std::vector<Obb> straight = bench::SceneMaker(5).make("town", count),
                           turned = bench::SceneMaker(5).make("town at 30", count);
    if (straight.empty()) return;
    const glm::dmat3 back = glm::dmat3(straight[0].axes) * glm::inverse(glm::dmat3(turned[0].axes));
    std::vector<Tree> trees;
    trees.emplace_back(turned, Orientation::aligned);
    trees.emplace_back(straight, Orientation::aligned);
    trees.emplace_back(turned, Orientation::automatic);
    std::puts(
        "\n| town at 30, shares of its aligned tree | depth | tests: straight town, automatic | time "
        "|\n|---|---|---|---|");
    for (const double depth : {1.0, 0.25, 0.06}) {
        const std::vector<Camera> cameras = cameras_in(turned, depth);
        std::vector<Camera> turned_back = cameras;
        for (Camera& camera : turned_back) {
            camera.position = straight[0].center + back * (camera.position - turned[0].center);
            camera.forward = back * camera.forward;
        }
        Measured m[3];
        time_views(trees, {views_of(cameras), views_of(turned_back), views_of(cameras)}, m);
        std::printf("| %zu boxes | %.2f | %.3f, %.3f | %.3f, %.3f |\n", turned.size(), depth, m[1].tests / m[0].tests,
                    m[2].tests / m[0].tests, m[1].microseconds / m[0].microseconds,
                    m[2].microseconds / m[0].microseconds);
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (!bench::take_target_option(argc, argv)) return 1;
    const auto count = static_cast<std::uint32_t>(argc > 1 ? std::atoi(argv[1]) : 100000);
    std::printf("Instruction set: %s; o: oriented, a: automatic, as shares of aligned\n\n", bench::target_in_use());
    std::puts(
        "| scene | boxes | nodes turned o, a | build ms, o, a | perimeters o, a | depth | tests o, a | us | "
        "time o, a |\n|---|---|---|---|---|---|---|---|---|");
    for (const char* name : bench::kTurnedScenes) {
        const std::vector<Obb> boxes = bench::SceneMaker(5).make(name, count);
        if (boxes.empty()) return 2;
        std::vector<Tree> trees;
        for (const Orientation kind : kKinds) trees.emplace_back(boxes, kind);
        for (const double depth : {1.0, 0.25, 0.06}) {
            Measured m[3];
            const std::vector<cull::View> views = views_of(cameras_in(boxes, depth));
            time_views(trees, {views, views, views}, m);
            std::printf(
                "| %s | %zu | %zu, %zu of %zu | %.0f, %.0f, %.0f | %.3f, %.3f | %.2f | %.3f, %.3f | %.2f | %.3f, %.3f "
                "|\n",
                name, boxes.size(), trees[1].turned, trees[2].turned, trees[0].tree.structure().nodes().size(),
                trees[0].build_ms, trees[1].build_ms, trees[2].build_ms, trees[1].perimeters / trees[0].perimeters,
                trees[2].perimeters / trees[0].perimeters, depth, m[1].tests / m[0].tests, m[2].tests / m[0].tests,
                m[0].microseconds, m[1].microseconds / m[0].microseconds, m[2].microseconds / m[0].microseconds);
        }
    }
    print_limit(count);
    return 0;
}
