// SPDX-License-Identifier: MIT
#include "pvs_scene.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "camera_path.hpp"

namespace crofton::pipeline {
namespace {

// Houses without a floor hide nothing from eyes below their walls, so a cell must not reach down to the ground.
constexpr double kLowestEye = 0.05;

}  // namespace

Result<PvsScene> make_pvs_scene(const assets::SceneSource& source, bool with_occluders, Executor& executor) {
    const scene::Scene& scene = source.scene;
    auto geometry = pvs::geometry_of(scene, source.movers);
    if (!geometry) return geometry.error();
    PvsScene result;
    result.geometry = std::move(*geometry);
    if (!with_occluders) return result;
    SceneOccluders found = find_scene_occluders(scene, executor);
    std::set<scene::NodeId> moving;
    for (const scene::InstanceId id : source.movers)
        if (!scene.is_removed(id)) moving.insert(scene.node_of(id));
    std::erase_if(found.objects, [&](const SceneOccluders::Object& object) { return moving.count(object.node) != 0; });
    result.found = std::make_shared<const SceneOccluders>(std::move(found));
    for (const SceneOccluders::Object& object : result.found->objects)
        for (const occlude::FoundOccluder& occluder : result.found->kinds[object.kind].found.occluders)
            result.occluders.push_back({&occluder, scene.world(object.node)});
    return result;
}

Aabb eyes_of(const scene::Scene& scene, double height) {
    Aabb eyes = focus_of(scene);
    if (eyes.is_empty()) return eyes;
    eyes.max.y = eyes.min.y + height;
    eyes.min.y += kLowestEye * height;
    return eyes;
}

}  // namespace crofton::pipeline
