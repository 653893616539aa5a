// SPDX-License-Identifier: MIT
// The meshes of a scene, cut into clusters.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/depth/depth_culler.hpp>
#include <crofton/scene/scene.hpp>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "assets/scene_source.hpp"

namespace crofton::pipeline {

struct SceneClusters {
    std::vector<std::shared_ptr<const depth::ClusteredMesh>> meshes;  // by mesh; empty where the mesh is removed

    // Bytes that the clusters hold.
    [[nodiscard]] std::size_t memory() const;
};

// Those of the source's file, which the source then has no longer; nullptr where it had none.
[[nodiscard]] std::shared_ptr<const SceneClusters> take_clusters(assets::SceneSource& source);

// Errors: as ClusteredMesh::cut(), with the mesh's number as the item.
[[nodiscard]] Result<SceneClusters> cut_scene(const scene::Scene& scene, Executor& executor);

// These instances as DepthCuller asks them, in their order, behind those that `objects` holds.
void append_depth_objects(const scene::Scene& scene, const SceneClusters& clusters,
                          std::span<const std::uint8_t> one_sided, std::span<const scene::InstanceId> instances,
                          const Camera& camera, std::vector<depth::DepthObject>& objects);

}  // namespace crofton::pipeline
