// SPDX-License-Identifier: MIT
// Baked data of a scene: its occluders and its potentially visible sets.
#pragma once
#include <crofton/pvs/pvs.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "assets/scene_source.hpp"
#include "scene_occluders.hpp"

namespace crofton::pipeline {

struct BakedParts {
    std::shared_ptr<const SceneOccluders> occluders;  // nullptr: the file has none of this scene
    std::shared_ptr<const pvs::Pvs> pvs;              // likewise
    // Parts in the file that were baked of another scene and are not above. Occluders: other meshes, nodes or
    // instances, with the first that differs. Sets: other triangles where they rest, or triangles that stand elsewhere.
    std::vector<Error> left_out;
};

// Loads a file of `crofton bake` or `crofton pvs`. The scene must be updated. Errors, which name the file: it cannot be
// read, is damaged, or has neither occluders nor sets.
[[nodiscard]] Result<BakedParts> load_baked_parts(const std::string& path, const scene::Scene& scene,
                                                  const assets::ReadLimits& limits = {});

// Whether meshes, and which node holds which, are the same in both: then what was found or baked for one is the
// other's.
[[nodiscard]] bool same_parts(const scene::Scene& a, const scene::Scene& b);

// Whether the sets were baked of this scene as it stands: what they hold has the same triangles in the same places.
[[nodiscard]] bool is_baked_of(const pvs::Pvs& pvs, const scene::Scene& scene);

}  // namespace crofton::pipeline
