// SPDX-License-Identifier: MIT
// A scene as one mesh in world coordinates, with the light that its faces give off.
#pragma once
#include <glm/vec3.hpp>
#include <vector>

#include "assets/scene_source.hpp"

namespace crofton::assets {

struct FlatScene {
    TriangleMesh mesh;                // three vertices a triangle, coloured (0.6 where the scene says nothing)
    std::vector<glm::vec3> emission;  // by triangle
};

// All instances' triangles; those of no area are left out. The scene has been updated. Errors: more than the limit of
// triangles, which instances multiply.
[[nodiscard]] Result<FlatScene> flat_scene(const SceneSource& source, const ReadLimits& limits = {});

// Those of all instances together.
[[nodiscard]] std::uint64_t instanced_triangles(const scene::Scene& scene);

}  // namespace crofton::assets
