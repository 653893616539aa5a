// SPDX-License-Identifier: MIT
#include "shared_scenes.hpp"

#include <algorithm>
#include <assets/scene_source.hpp>
#include <cmath>
#include <cstdio>
#include <string>

namespace crofton::bench {
namespace {

// A scene's boxes in a square of side 1 from the origin on.
std::vector<Obb> unit_scene(const std::string& path) {
    auto source = assets::load_scene(path);
    if (!source) {
        std::fprintf(stderr, "%s: %s\n", path.c_str(), source.error().message.c_str());
        return {};
    }
    source->scene.update();
    std::vector<Obb> boxes(source->scene.world_boxes().begin(), source->scene.world_boxes().end());
    Aabb all;
    for (const Obb& box : boxes) {
        const Aabb bound = aabb_of(box);
        all.min = glm::min(all.min, bound.min);
        all.max = glm::max(all.max, bound.max);
    }
    const double scale = 1.0 / std::max(all.max.x - all.min.x, all.max.z - all.min.z);
    for (Obb& box : boxes) {
        box.center = scale * (box.center - all.min);
        box.half_extents *= static_cast<float>(scale);
    }
    return boxes;
}

}  // namespace

std::vector<Obb> shared_boxes(std::size_t count) {
    std::vector<std::vector<Obb>> scenes;
    std::size_t of_all = 0;
    for (const char* name : {"stk_black_forest.glb", "freedoom2_maps.wad"}) {
        scenes.push_back(unit_scene(std::string(CROFTON_SHARED_DATA "/scenes/") + name));
        of_all += scenes.back().size();
        if (scenes.back().empty()) scenes.pop_back();
    }
    std::vector<Obb> boxes;
    if (scenes.empty()) return boxes;
    const double squares = std::ceil(static_cast<double>(count * scenes.size()) / static_cast<double>(of_all));
    const auto across = static_cast<std::size_t>(std::ceil(std::sqrt(squares)));
    const double side = std::cbrt(static_cast<double>(count)), scale = side / static_cast<double>(across);
    boxes.reserve(count);
    for (std::size_t square = 0; boxes.size() < count; ++square) {
        const glm::dvec3 corner(static_cast<double>(square % across), 0.0, static_cast<double>(square / across));
        for (Obb box : scenes[square % scenes.size()]) {
            if (boxes.size() == count) break;
            box.center = scale * (corner + box.center) + glm::dvec3(0.0, 0.45 * side, 0.0);
            box.half_extents *= static_cast<float>(scale);
            boxes.push_back(box);
        }
    }
    return boxes;
}

}  // namespace crofton::bench
