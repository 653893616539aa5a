// SPDX-License-Identifier: MIT
// Scene sources as .crofton files: the engine's scene, and what the samples know besides.
#pragma once
#include <crofton/bake/baked_scene.hpp>

#include "assets/scene_source.hpp"

namespace crofton::assets {

// Bakes the source as of its last update: the scene with the looks of its meshes, then the path to walk, the rooms and
// the light that faces give off, as sections of their own. `options.looks` is replaced. What moves is baked where it
// stands. Errors: as bake::bake.
[[nodiscard]] Result<Vector<std::byte>> bake_source(const SceneSource& source, Executor& executor,
                                                    bake::BakeOptions options = {});

// How the source's meshes are drawn, by mesh.
[[nodiscard]] std::vector<bake::MeshLook> looks_of(const SceneSource& source);

// Adds to the source what bake_source() wrote besides the scene. Errors name the section: numbers out of range, counts
// that do not fit the scene.
[[nodiscard]] Result<void> read_visit(std::span<const std::byte> file, SceneSource& source);

}  // namespace crofton::assets
