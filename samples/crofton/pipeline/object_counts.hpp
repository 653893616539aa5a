// SPDX-License-Identifier: MIT
// Counts the objects whose triangles meet the frustum, which bounds cannot tell.
#pragma once
#include <crofton/cull/classify.hpp>
#include <crofton/depth/depth_culler.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/scene/scene.hpp>
#include <cstdint>
#include <span>
#include <vector>

#include "drawables.hpp"
#include "scene_clusters.hpp"

namespace crofton::pipeline {

struct ObjectCounts {
    std::uint64_t triangles_submitted = 0;  // of the visible instances
    std::uint64_t triangles_passed = 0;     // that meet the frustum, exactly
    std::uint64_t improper = 0;             // the bound straddles, the object lies outside or inside
};

// Reuses its scratch memory from call to call.
class ObjectCounter {
  public:
    // `verdicts` by instance; only straddling instances are looked into.
    [[nodiscard]] ObjectCounts count(const Drawables& drawables, const Frustum& frustum,
                                     std::span<const scene::InstanceId> visible,
                                     std::span<const cull::Verdict> verdicts);

    // How many of these triangles meet the frustum, exactly; objects are instances.
    [[nodiscard]] std::uint64_t count(const Drawables& drawables, const Frustum& frustum, const SceneClusters& clusters,
                                      std::span<const depth::VisibleCluster> visible);

  private:
    std::vector<glm::dvec3> points_;
    std::vector<std::uint16_t> outside_;  // bit k: the point lies outside plane k by more than rounding
};

}  // namespace crofton::pipeline
