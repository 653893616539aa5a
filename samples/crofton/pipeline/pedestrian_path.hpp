// SPDX-License-Identifier: MIT
// Where one could walk in a scene that does not say so itself.
#pragma once
#include <crofton/geometry/box.hpp>
#include <crofton/scene/scene.hpp>
#include <vector>

namespace crofton::pipeline {

// A path through the middle of `focus` along its longer side, at eye height above the lowest floor with room to stand;
// points without any floor are left out. y is up. Looks at every triangle once.
[[nodiscard]] std::vector<glm::dvec3> find_pedestrian_path(const scene::Scene& scene, const Aabb& focus);

}  // namespace crofton::pipeline
