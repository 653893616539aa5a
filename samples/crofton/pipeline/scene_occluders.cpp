// SPDX-License-Identifier: MIT
#include "scene_occluders.hpp"

#include <map>
#include <utility>

namespace crofton::pipeline {
namespace {

void append(TriangleMesh& to, const TriangleMesh& part) {
    const auto first = static_cast<std::uint32_t>(to.positions.size());
    to.positions.insert(to.positions.end(), part.positions.begin(), part.positions.end());
    for (const std::uint32_t index : part.indices) to.indices.push_back(first + index);
}

}  // namespace

SceneOccluders find_scene_occluders(const scene::Scene& scene, Executor& executor) {
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
        for (const scene::MeshId mesh : meshes) append(result.kinds.back().mesh, scene.mesh(mesh));
    }
    executor.parallel_for(result.kinds.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t k = begin; k < end; ++k)
            if (auto found = occlude::find_occluders(result.kinds[k].mesh)) result.kinds[k].found = std::move(*found);
    });
    std::erase_if(result.objects, [&](const SceneOccluders::Object& object) {
        return result.kinds[object.kind].found.occluders.empty();
    });
    return result;
}

}  // namespace crofton::pipeline
