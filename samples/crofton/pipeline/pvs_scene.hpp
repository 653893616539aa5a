// SPDX-License-Identifier: MIT
// Data for baking visible sets that the scene does not have itself.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/pvs/pvs.hpp>
#include <memory>
#include <vector>

#include "assets/scene_source.hpp"
#include "scene_occluders.hpp"

namespace crofton::pipeline {

struct PvsScene {
    pvs::BakeGeometry geometry;                   // objects are instances; the source's movers are left out
    std::shared_ptr<const SceneOccluders> found;  // but those of movers; nullptr without
    std::vector<pvs::PlacedOccluder> occluders;   // in `found`
};

// The scene has been updated. Errors: as pvs::geometry_of.
[[nodiscard]] Result<PvsScene> make_pvs_scene(const assets::SceneSource& source, bool with_occluders,
                                              Executor& executor = serial_executor());

// Where the scene is dense (focus_of), from a twentieth of `height` to `height` above its lowest point. y is up.
[[nodiscard]] Aabb eyes_of(const scene::Scene& scene, double height);

}  // namespace crofton::pipeline
