// SPDX-License-Identifier: MIT
// Finds occluders in scenes that have none.
#pragma once
#include <crofton/bake/baked_scene.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/occlude/occluder.hpp>
#include <crofton/scene/scene.hpp>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace crofton::pipeline {

// A node of more meshes is a level that was cut into pieces, not a house of several parts.
inline constexpr std::size_t kMostParts = 16;
// Triangles of a level's surfaces.
inline constexpr std::uint32_t kLevelTriangles = 48;

// Instances on one node are one object, as houses of several parts are: occluders are found in its meshes together.
struct SceneOccluders {
    struct Kind {
        TriangleMesh mesh;      // all parts, in the node's frame
        bool is_level = false;  // so many parts that their surfaces are welded
        occlude::FoundOccluders found;
    };
    struct Object {
        scene::NodeId node = scene::kNone;
        std::uint32_t kind = 0;
    };
    std::vector<Kind> kinds;
    std::vector<Object> objects;  // by node, ascending; those that have occluders
};

// Looks at each set of meshes once, however many nodes have it. Faces count from their front alone, which is right
// however they are drawn. Meshes in which no occluder is found hide nothing.
[[nodiscard]] SceneOccluders find_scene_occluders(const scene::Scene& scene, Executor& executor);

// The same from what was baked of this scene, without finding anything.
[[nodiscard]] SceneOccluders scene_occluders_from(const scene::Scene& scene, const bake::BakedOccluders& baked);
[[nodiscard]] bake::BakedOccluders to_baked(const SceneOccluders& occluders);

}  // namespace crofton::pipeline
