// SPDX-License-Identifier: MIT
// glTF assets made of our own meshes.
#pragma once
#include <crofton/scene/scene.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "assets/gltf_document.hpp"
#include "assets/obj_file.hpp"

namespace crofton::assets {

// One node per instance with its world transform, one mesh per mesh of the scene, with its colours.
[[nodiscard]] GltfDocument gltf_from_scene(const scene::Scene& scene);

// One mesh and node per run of parts of one name, a primitive for each of its materials. A vertex is a triple of
// position, texture coordinate and normal; corners with and without them are primitives of their own. Materials have
// the library's colour, emission and texture (looked for in `folder`, and taken in); vertex colours stand in the place
// of the material's colour.
[[nodiscard]] GltfDocument gltf_from_obj(const ObjFile& file, const std::string& folder);

// Accessors of vertex data; positions come with their bounds.
[[nodiscard]] std::size_t append_positions(GltfDocument& document, std::span<const glm::vec3> positions);
[[nodiscard]] std::size_t append_vectors(GltfDocument& document, std::span<const glm::vec3> vectors);
[[nodiscard]] std::size_t append_vectors(GltfDocument& document, std::span<const glm::vec2> vectors);
[[nodiscard]] std::size_t append_indices(GltfDocument& document, std::span<const std::uint32_t> indices);

}  // namespace crofton::assets
