// SPDX-License-Identifier: MIT
// Boxes that hide, boxes behind them, and a camera: at random, and as they are known to break occlusion cullers.
#pragma once
#include <crofton/sampling/sampling.hpp>
#include <oracle/occlusion_scenes.hpp>
#include <vector>

namespace crofton::cli {

using OccludeSetup = test::OcclusionScene;

// Walls, boxes that touch, slivers, boxes around the eye and across the near plane; objects behind and between them.
[[nodiscard]] OccludeSetup random_setup(sampling::Random& random, double offset);

// Objects are put where a ray through an opening ends, so that a witness is found for many.
struct HardSetup {
    const char* name;
    OccludeSetup (*make)(sampling::Random& random, double offset);
    std::uint64_t trials_a_ray = 5;  // more where rays are dear
};
[[nodiscard]] std::vector<HardSetup> hard_setups();

}  // namespace crofton::cli
