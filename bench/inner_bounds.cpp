// SPDX-License-Identifier: MIT
// By what should inner nodes be bounded? For each kind of bound the expected cost of a query, T = N_v · C_v + N_p ·
// C_p: bounds tested times the cost of one test, plus items' boxes tested times theirs. One tree each, one flight each;
// only the bounds differ. usage: bench_inner_bounds [SCENE…]   SCENE: crowd:N, town:N or a file
#include <algorithm>
#include <assets/scene_source.hpp>
#include <chrono>
#include <cmath>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/fit/fit.hpp>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>

#include "cull_crowd.hpp"

namespace {

using namespace crofton;

// Six planes against 16 children in plain float arrays, the same code for all kinds: nanoseconds a child.
struct Block {
    alignas(64) float center[3][16], half[3][16], edge[9][16];
    alignas(64) std::uint8_t low[3][16], high[3][16];
    float out[16];
};

enum class Kind { aabb, quantised, obb };

template <Kind kKind>
[[gnu::noinline]] void test(const float (&planes)[6][4], Block& block) {
    for (int i = 0; i < 16; ++i) {
        float least = 1e30f;
        float c[3], h[3];
        for (int j = 0; j < 3; ++j) {
            if constexpr (kKind == Kind::quantised) {
                const float low = static_cast<float>(block.low[j][i]), high = static_cast<float>(block.high[j][i]);
                c[j] = (low + high) * 0.5f;
                h[j] = (high - low) * 0.5f;
            } else {
                c[j] = block.center[j][i];
                h[j] = block.half[j][i];
            }
        }
        for (const auto& p : planes) {
            float projected_radius;
            if constexpr (kKind == Kind::obb) {
                projected_radius = 0.0f;
                for (int k = 0; k < 9; k += 3)
                    projected_radius +=
                        std::fabs(p[0] * block.edge[k][i] + p[1] * block.edge[k + 1][i] + p[2] * block.edge[k + 2][i]);
            } else {
                projected_radius = std::fabs(p[0]) * h[0] + std::fabs(p[1]) * h[1] + std::fabs(p[2]) * h[2];
            }
            const float top = p[0] * c[0] + p[1] * c[1] + p[2] * c[2] + p[3] + projected_radius;
            least = top < least ? top : least;
        }
        block.out[i] = least;
    }
}

template <Kind kKind>
double cost_of() {
    static std::vector<Block> blocks(64);
    float planes[6][4];
    std::mt19937 random(1);
    for (auto& p : planes)
        for (float& x : p) x = std::uniform_real_distribution<float>(-1, 1)(random);
    double best = 1e9;
    for (int repetition = 0; repetition < 200; ++repetition) {
        const auto start = std::chrono::steady_clock::now();
        for (Block& block : blocks) test<kKind>(planes, block);
        const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - start;
        best = std::min(best, time.count() / (16.0 * static_cast<double>(blocks.size())));
    }
    return best;
}

// The bounds of every child of every node, of one kind, as boxes.
using Bounds = std::vector<std::array<Obb, boxtree::kWidth>>;

Bounds aabbs(const boxtree::BoxTree& tree, unsigned steps) {
    Bounds bounds(tree.structure().nodes().size());
    for (boxtree::NodeId n = 0; n < bounds.size(); ++n) {
        Aabb whole;
        for (unsigned lane = 0; lane < tree.structure().nodes()[n].count; ++lane)
            whole.include(tree.structure().child_bounds(n, lane));
        for (unsigned lane = 0; lane < tree.structure().nodes()[n].count; ++lane) {
            Aabb box = tree.structure().child_bounds(n, lane);
            // Corners on a grid of `steps` cells across the node.
            for (int j = 0; j < 3 && steps > 0; ++j) {
                const double cell = (whole.max[j] - whole.min[j]) / steps;
                if (!(cell > 0.0)) continue;
                box.min[j] = whole.min[j] + cell * std::floor((box.min[j] - whole.min[j]) / cell);
                box.max[j] = whole.min[j] + cell * std::ceil((box.max[j] - whole.min[j]) / cell);
            }
            bounds[n][lane] = obb_of(box);
        }
    }
    return bounds;
}

// Around a leaf's boxes, and around the children's boxes above.
Bounds obbs(const boxtree::BoxTree& tree) {
    const measure::Criterion criterion = measure::minimal_perimeter();
    Bounds bounds(tree.structure().nodes().size());
    for (auto n = static_cast<boxtree::NodeId>(bounds.size()); n-- > 0;) {
        const boxtree::Node& node = tree.structure().nodes()[n];
        for (unsigned lane = 0; lane < node.count; ++lane) {
            std::vector<Obb> below;
            const std::uint32_t child = node.child[lane], id = child & ~boxtree::kLeafBit;
            if (child & boxtree::kLeafBit)
                for (unsigned i = 0; i < tree.structure().leaves()[id].count; ++i)
                    below.push_back(tree.boxes()[tree.structure().slot_items()[id * boxtree::kWidth + i]]);
            else
                below.assign(bounds[id].begin(), bounds[id].begin() + tree.structure().nodes()[id].count);
            bounds[n][lane] = *fit::merge(below, criterion);
        }
    }
    return bounds;
}

struct Work {
    double nodes = 0.0, boxes = 0.0;
};

Work walk(const boxtree::BoxTree& tree, const Bounds& bounds, const std::vector<cull::View>& views) {
    Work work;
    std::vector<boxtree::NodeId> stack;
    for (const cull::View& view : views) {
        stack.assign(1, 0);
        while (!stack.empty()) {
            const boxtree::NodeId n = stack.back();
            stack.pop_back();
            const boxtree::Node& node = tree.structure().nodes()[n];
            work.nodes += node.count;
            for (unsigned lane = 0; lane < node.count; ++lane) {
                if (cull::classify(view.frustum, bounds[n][lane], cull::CullMode::conservative) !=
                    cull::Verdict::straddling)
                    continue;
                const std::uint32_t child = node.child[lane];
                if (child & boxtree::kLeafBit)
                    work.boxes += tree.structure().leaves()[child & ~boxtree::kLeafBit].count;
                else
                    stack.push_back(child);
            }
        }
    }
    work.nodes /= static_cast<double>(views.size());
    work.boxes /= static_cast<double>(views.size());
    return work;
}

std::vector<cull::View> flight(const Aabb& scene) {
    std::mt19937_64 random(7);
    const auto number = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    std::vector<cull::View> views;
    for (int i = 0; i < 60; ++i) {
        Camera camera;
        for (int j = 0; j < 3; ++j) camera.position[j] = number(scene.min[j], scene.max[j]);
        camera.forward = {number(-1, 1), number(-0.3, 0.3), number(-1, 1)};
        camera.far_distance = glm::length(scene.max - scene.min);
        views.push_back({*frustum_of(camera)});
    }
    return views;
}

std::vector<Obb> load(const std::string& name) {
    const std::size_t colon = name.find(':');
    const auto count = colon == std::string::npos ? 0 : static_cast<std::uint32_t>(std::atoi(name.c_str() + colon + 1));
    if (name.rfind("crowd:", 0) == 0) return bench::crowd(count);
    assets::LoadOptions options;
    options.instances = count;
    auto source = assets::load_scene(name.substr(0, colon), options);
    if (!source) {
        std::fprintf(stderr, "%s: %s\n", name.c_str(), source.error().message.c_str());
        return {};
    }
    source->scene.update();
    return {source->scene.world_boxes().begin(), source->scene.world_boxes().end()};
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<std::string> scenes(argv + 1, argv + argc);
    if (scenes.empty()) scenes = {"crowd:10000", "crowd:100000", "town:10000", "town:100000"};
    const double aabb = cost_of<Kind::aabb>(), quantised = cost_of<Kind::quantised>(), obb = cost_of<Kind::obb>();
    std::printf("cost of a test in ns, C_v: AABB %.2f, AABB quantised to 8 bits %.2f, OBB %.2f = C_p\n", aabb,
                quantised, obb);
    std::printf("%-40s %10s %12s %12s %10s\n", "scene, inner bound", "items", "N_v", "N_p", "T in us");
    for (const std::string& scene : scenes) {
        const std::vector<Obb> boxes = load(scene);
        if (boxes.empty()) return 2;
        const auto tree = boxtree::BoxTree::build(boxes);
        if (!tree) return 2;
        Aabb whole;
        for (const Obb& box : boxes) whole.include(box.center);
        const std::vector<cull::View> views = flight(whole);
        const auto row = [&](const char* kind, const Bounds& bounds, double cost) {
            const Work work = walk(*tree, bounds, views);
            std::printf("%-40s %10zu %12.0f %12.0f %10.2f\n",
                        (scene.substr(scene.rfind('/') + 1) + ", " + kind).c_str(), boxes.size(), work.nodes,
                        work.boxes, 1e-3 * (work.nodes * cost + work.boxes * obb));
        };
        row("AABB", aabbs(*tree, 0), aabb);
        row("AABB, 8 bits", aabbs(*tree, 255), quantised);
        row("OBB", obbs(*tree), obb);
    }
    return 0;
}
