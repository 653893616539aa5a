// SPDX-License-Identifier: MIT
// What was baked for a scene beside the scene itself: its occluders, its potentially visible sets.
#pragma once
#include <crofton/pvs/pvs.hpp>
#include <memory>
#include <optional>
#include <string>

#include "assets/scene_source.hpp"
#include "scene_occluders.hpp"

namespace crofton::pipeline {

struct BakedParts {
    std::shared_ptr<const SceneOccluders> occluders;  // nullptr: the file has none
    std::shared_ptr<const pvs::Pvs> pvs;              // likewise
};

// Of a file by `crofton bake` or `crofton pvs`. The scene has been updated. Errors name the file: what cannot be read
// or is damaged; neither occluders nor sets in it; baked of another scene, that is other meshes, nodes or instances,
// with the first that differs.
[[nodiscard]] Result<BakedParts> load_baked_parts(const std::string& path, const scene::Scene& scene,
                                                  const assets::ReadLimits& limits = {});

// Whether meshes, and which node holds which, are the same in both: then what was found or baked for one is the
// other's.
[[nodiscard]] bool same_parts(const scene::Scene& a, const scene::Scene& b);

}  // namespace crofton::pipeline
