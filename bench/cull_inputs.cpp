// SPDX-License-Identifier: MIT
#include "cull_inputs.hpp"

#include <algorithm>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <cstdio>
#include <map>
#include <string_view>

#if defined(CROFTON_BENCH_ASSETS)
#include "shared_scenes.hpp"
#endif

namespace crofton::bench {
namespace {

enum class Scene { crowd, city, debris, shared };
#if defined(CROFTON_BENCH_ASSETS)
constexpr const char* kScenes[] = {"crowd", "city", "debris", "shared"};
#else
constexpr const char* kScenes[] = {"crowd", "city", "debris"};
#endif
Scene scene = Scene::crowd;

// `box` turned at random, about the vertical only or about any axis.
void turn(Obb& box, std::mt19937_64& random, bool upright) {
    std::normal_distribution<double> normal;
    const double w = normal(random), x = normal(random), y = normal(random), z = normal(random);
    box.axes = glm::mat3(glm::mat3_cast(glm::normalize(upright ? glm::dquat(w, 0.0, y, 0.0) : glm::dquat(w, x, y, z))));
}

// Quarters, which the centres of nine boxes in ten crowd around; sizes over four decades, each the rarer the larger it
// is; walls, poles and plates: sides that differ by up to 30 times; upright. In the crowd's cube, but low.
std::vector<Obb> city(std::size_t count) {
    std::mt19937_64 random(count);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::normal_distribution<double> normal;
    const double side = std::cbrt(static_cast<double>(count));
    std::vector<glm::dvec3> quarters(1 + count / 4000);
    for (glm::dvec3& quarter : quarters) {
        quarter.x = side * unit(random);
        quarter.y = side * (0.4 + 0.1 * unit(random));
        quarter.z = side * unit(random);
    }
    std::vector<Obb> boxes(count);
    for (Obb& box : boxes) {
        const glm::dvec3& quarter =
            quarters[static_cast<std::size_t>(unit(random) * 0.999999 * double(quarters.size()))];
        const double spread = 0.02 * side, x = normal(random), y = normal(random), z = normal(random);
        box.center = quarter + spread * glm::dvec3(x, 0.3 * y, z);
        if (unit(random) < 0.1) {
            box.center.x = side * unit(random);
            box.center.z = side * unit(random);
        }
        box.center = glm::clamp(box.center, glm::dvec3(0.0), glm::dvec3(side));
        const double size = 0.002 * std::pow(10.0, 4.0 * std::pow(unit(random), 4.0));
        for (int k = 0; k < 3; ++k) box.half_extents[k] = static_cast<float>(size * std::pow(30.0, -unit(random)));
        turn(box, random, true);
    }
    return boxes;
}

// Heaps of splinters that are turned at random and lie in each other.
std::vector<Obb> debris(std::size_t count) {
    std::mt19937_64 random(count);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::normal_distribution<double> normal;
    const double side = std::cbrt(static_cast<double>(count));
    std::vector<Obb> boxes(count);
    glm::dvec3 heap(0.0);
    for (std::size_t i = 0; i < count; ++i) {
        if (i % 500 == 0)
            for (int j = 0; j < 3; ++j) heap[j] = side * unit(random);
        for (int j = 0; j < 3; ++j) boxes[i].center[j] = std::clamp(heap[j] + 0.01 * side * normal(random), 0.0, side);
        for (int k = 0; k < 3; ++k) boxes[i].half_extents[k] = static_cast<float>(0.3 * std::pow(50.0, -unit(random)));
        turn(boxes[i], random, false);
    }
    return boxes;
}

std::vector<Obb> make_boxes(std::size_t count) {
#if defined(CROFTON_BENCH_ASSETS)
    if (scene == Scene::shared) return shared_boxes(count);
#endif
    return scene == Scene::city ? city(count) : scene == Scene::debris ? debris(count) : crowd(count);
}

}  // namespace

bool take_scene_option(int& argc, char** argv) {
    constexpr std::string_view kOption = "--scene=";
    for (int i = 1; i < argc; ++i) {
        const std::string_view argument = argv[i];
        if (!argument.starts_with(kOption)) continue;
        const auto found = std::ranges::find(kScenes, argument.substr(kOption.size()),
                                             [](const char* name) { return std::string_view(name); });
        if (found == std::end(kScenes)) {
            std::fprintf(stderr, "%s: no such scene; there are:", argv[i]);
            for (const char* name : kScenes) std::fprintf(stderr, " %s", name);
            std::fputc('\n', stderr);
            return false;
        }
        scene = static_cast<Scene>(found - kScenes);
        std::copy(argv + i + 1, argv + argc, argv + i);
        --argc;
        --i;
    }
    return true;
}

const char* scene_in_use() {
    return kScenes[static_cast<int>(scene)];
}

void leave_caches_cold() {
    static std::vector<std::uint64_t> memory(std::size_t{16} << 20);  // 128 MB
    for (std::size_t i = 0; i < memory.size(); i += 8) ++memory[i];
    benchmark::ClobberMemory();
}

const std::vector<Obb>& boxes_of(std::int64_t count) {
    static std::map<std::int64_t, std::vector<Obb>> made;
    auto& boxes = made[count];
    if (boxes.empty()) boxes = make_boxes(static_cast<std::size_t>(count));
    return boxes;
}

const boxtree::BoxTree& tree_of(std::int64_t count) {
    static std::map<std::int64_t, boxtree::BoxTree> made;
    auto found = made.find(count);
    if (found == made.end()) found = made.emplace(count, *boxtree::BoxTree::build(boxes_of(count))).first;
    return found->second;
}

void report(benchmark::State& state, std::size_t visible) {
    state.counters["visible"] = static_cast<double>(visible);
    state.counters["ns_per_box"] =
        benchmark::Counter(static_cast<double>(state.range(0)) * 1e-9,
                           benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

const std::vector<Obb>& boxes_in_tree_order(std::int64_t count) {
    static std::map<std::int64_t, std::vector<Obb>> made;
    auto& boxes = made[count];
    if (boxes.empty())
        for (const boxtree::ItemId item : tree_of(count).structure().slot_items())
            if (item != boxtree::kNone) boxes.push_back(boxes_of(count)[item]);
    return boxes;
}

}  // namespace crofton::bench
