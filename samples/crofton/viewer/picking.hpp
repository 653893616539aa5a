// SPDX-License-Identifier: MIT
// Finds the object under the cursor.
#pragma once
#include <crofton/crofton.hpp>
#include <crofton/scene/scene.hpp>
#include <optional>
#include <span>

#include "instance_shapes.hpp"
#include "pipeline/region_pipeline.hpp"

namespace crofton::viewer {

struct Pick {
    scene::InstanceId instance = 0;
    std::uint32_t triangle = 0;
    double distance = 0.0;
    glm::dvec3 at{0.0};
};

// The nearest triangle of `candidates` on the ray through `cursor`, given in [−1, 1]² with y up. `world` has bounds of
// the instances as its objects of pipeline::kSeenLayer, with their numbers as user data. Candidates ascend.
[[nodiscard]] std::optional<Pick> pick(const World& world, InstanceShapes& shapes,
                                       std::span<const scene::InstanceId> candidates, const Camera& camera,
                                       const glm::dvec2& cursor);
// The same among regions that are attached.
[[nodiscard]] std::optional<Pick> pick(const pipeline::RegionPipeline& regions,
                                       std::span<const scene::InstanceId> candidates, const Camera& camera,
                                       const glm::dvec2& cursor);

}  // namespace crofton::viewer
