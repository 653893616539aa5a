// SPDX-License-Identifier: MIT
#include "scene_occluders.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace crofton::pipeline {
namespace {

// Nodes with the same meshes are of one kind; no occluders yet.
SceneOccluders kinds_of(const scene::Scene& scene) {
    std::map<scene::NodeId, std::vector<scene::MeshId>> parts;
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i)
        if (!scene.is_removed(i) && scene.layer_masks()[i] != 0) parts[scene.node_of(i)].push_back(scene.mesh_of(i));

    SceneOccluders result;
    std::map<std::vector<scene::MeshId>, std::uint32_t> kinds;
    for (const auto& [node, meshes] : parts) {
        const auto [kind, is_new] = kinds.try_emplace(meshes, static_cast<std::uint32_t>(result.kinds.size()));
        result.objects.push_back({node, kind->second});
        if (!is_new) continue;
        result.kinds.emplace_back();
        result.kinds.back().is_level = meshes.size() > kMostParts;
        for (const scene::MeshId mesh : meshes) append(result.kinds.back().mesh, scene.mesh(mesh));
    }
    return result;
}

void find_in(SceneOccluders::Kind& kind) {
    if (auto found = occlude::find_occluders(kind.mesh, {.level_triangles = kind.is_level ? kLevelTriangles : 0}))
        kind.found = std::move(*found);
}

void forget_what_hides_nothing(SceneOccluders& occluders) {
    std::erase_if(occluders.objects, [&](const SceneOccluders::Object& object) {
        return occluders.kinds[object.kind].found.occluders.empty();
    });
}

}  // namespace

SceneOccluders find_scene_occluders(const scene::Scene& scene, Executor& executor) {
    SceneOccluders result = kinds_of(scene);
    executor.parallel_for(result.kinds.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t k = begin; k < end; ++k) find_in(result.kinds[k]);
    });
    forget_what_hides_nothing(result);
    return result;
}

SceneOccluders scene_occluders_from(const scene::Scene& scene, const bake::BakedOccluders& baked) {
    SceneOccluders result = kinds_of(scene);
    for (const SceneOccluders::Object& object : result.objects) {
        Vector<occlude::FoundOccluder>& own = result.kinds[object.kind].found.occluders;
        if (!own.empty()) continue;
        const auto known =
            std::lower_bound(baked.nodes.begin(), baked.nodes.end(), object.node,
                             [](const bake::OccludingNode& entry, scene::NodeId node) { return entry.node < node; });
        if (known != baked.nodes.end() && known->node == object.node) own = baked.kinds[known->kind];
    }
    forget_what_hides_nothing(result);
    return result;
}

bake::BakedOccluders to_baked(const SceneOccluders& occluders) {
    bake::BakedOccluders baked;
    for (const SceneOccluders::Kind& kind : occluders.kinds) baked.kinds.push_back(kind.found.occluders);
    for (const SceneOccluders::Object& object : occluders.objects) baked.nodes.push_back({object.node, object.kind});
    return baked;
}

}  // namespace crofton::pipeline
