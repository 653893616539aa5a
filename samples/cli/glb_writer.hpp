// A scene's meshes as one binary glTF file.
#pragma once
#include <crofton/scene/scene.hpp>
#include <span>
#include <string>

namespace crofton::cli {

// One node per instance with its world transform, one mesh per mesh of the scene, its triangles and colours taken from
// `meshes`, by MeshId.
[[nodiscard]] std::string make_glb(const scene::Scene& scene, std::span<const TriangleMesh> meshes);

}  // namespace crofton::cli
