// SPDX-License-Identifier: MIT
// Where `--camera street` leads in a scene.
#pragma once
#include <crofton/bake/region_files.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "assets/scene_source.hpp"
#include "camera_path.hpp"
#include "free_space.hpp"

namespace crofton::pipeline {

// A way to walk, and what PathOptions need for it.
struct Street {
    std::vector<glm::dvec3> walk;    // empty: nothing to walk on
    std::optional<FreeSpace> space;  // none where the scene brought its own walk, or there is no space
    glm::dvec3 origin{0.0};          // of the space's coordinates
    std::string remark;              // why the eye is not at a person's height; empty where it is

    // Sets what the path takes from the street, which must outlive the options.
    void set(PathOptions& options) const;
};

// The walk that comes with the town and the room; of other scenes one through their free space. The scene has been
// updated.
[[nodiscard]] Street street_of(const assets::SceneSource& source, const Aabb& focus);

// A street through the regions in the middle of a world, of which it reads a few: those that together have 4,000
// objects, or one. Errors: as load_scene.
[[nodiscard]] Result<Street> street_of_regions(const std::string& folder, std::span<const bake::RegionFile> index,
                                               const assets::ReadLimits& limits);

}  // namespace crofton::pipeline
