// SPDX-License-Identifier: MIT
#include "scene_clusters.hpp"

#include <crofton/render/clip_space.hpp>
#include <utility>

#include "drawables.hpp"

namespace crofton::pipeline {

std::size_t SceneClusters::memory() const {
    std::size_t sum = 0;
    for (const auto& mesh : meshes) sum += mesh->memory();
    return sum;
}

std::shared_ptr<const SceneClusters> take_clusters(assets::SceneSource& source) {
    if (source.clusters.empty()) return nullptr;
    SceneClusters result;
    for (depth::ClusteredMesh& mesh : source.clusters)
        result.meshes.push_back(std::make_shared<const depth::ClusteredMesh>(std::move(mesh)));
    source.clusters = {};
    return std::make_shared<const SceneClusters>(std::move(result));
}

Result<SceneClusters> cut_scene(const scene::Scene& scene, Executor& executor) {
    std::vector<Result<depth::ClusteredMesh>> cut(scene.mesh_count());
    executor.parallel_for(cut.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t m = begin; m < end; ++m) {
            const auto mesh = static_cast<scene::MeshId>(m);
            if (scene.is_mesh_removed(mesh)) continue;
            cut[m] = depth::ClusteredMesh::cut(scene.mesh(mesh).positions, scene.mesh(mesh).indices);
        }
    });
    SceneClusters result;
    result.meshes.reserve(cut.size());
    for (std::size_t m = 0; m < cut.size(); ++m) {
        if (!cut[m]) return fail(cut[m].error().code, m, cut[m].error().message);
        result.meshes.push_back(std::make_shared<const depth::ClusteredMesh>(std::move(*cut[m])));
    }
    return result;
}

void append_depth_objects(const scene::Scene& scene, const SceneClusters& clusters,
                          std::span<const std::uint8_t> one_sided, std::span<const scene::InstanceId> instances,
                          const Camera& camera, std::vector<depth::DepthObject>& objects) {
    const render::ModelToClip to_clip(camera);
    for (const scene::InstanceId instance : instances) {
        const Transform& place = scene.world(scene.node_of(instance));
        objects.push_back({.mesh = clusters.meshes[scene.mesh_of(instance)].get(),
                           .to_clip = to_clip(place.linear, place.translation),
                           .one_sided = is_one_sided(SceneDrawables(scene), one_sided, instance)});
    }
}

}  // namespace crofton::pipeline
