// SPDX-License-Identifier: MIT
#include "scene_clusters.hpp"

namespace crofton::pipeline {

std::size_t SceneClusters::memory() const {
    std::size_t sum = 0;
    for (const depth::ClusteredMesh& mesh : meshes) sum += mesh.memory();
    return sum;
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
        result.meshes.push_back(std::move(*cut[m]));
    }
    return result;
}

}  // namespace crofton::pipeline
