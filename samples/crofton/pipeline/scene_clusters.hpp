// SPDX-License-Identifier: MIT
// The meshes of a scene, cut into clusters.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/depth/clustered_mesh.hpp>
#include <crofton/scene/scene.hpp>
#include <vector>

namespace crofton::pipeline {

struct SceneClusters {
    std::vector<depth::ClusteredMesh> meshes;  // by mesh; empty where the mesh is removed

    // Bytes that the clusters hold.
    [[nodiscard]] std::size_t memory() const;
};

// Errors: as ClusteredMesh::cut(), with the mesh's number as the item.
[[nodiscard]] Result<SceneClusters> cut_scene(const scene::Scene& scene, Executor& executor);

}  // namespace crofton::pipeline
