// Scenes into patches, and lit patches into files.
#pragma once
#include <crofton/radiosity/patches.hpp>
#include <crofton/scene/scene.hpp>
#include <string>

namespace crofton::cli {

// Three vertices a triangle, coloured by radiosity · exposure, 1 and above as 1.
[[nodiscard]] TriangleMesh baked(const radiosity::Patches& patches, std::span<const glm::vec3> radiosity,
                                 double exposure);

// Binary glTF with vertex colours and an unlit material (KHR_materials_unlit).
[[nodiscard]] Result<void> write_glb(const std::string& path, const TriangleMesh& mesh);

// One picture of the unlit mesh through the rasterizer, as PNG.
[[nodiscard]] Result<void> write_lit_picture(const std::string& path, const TriangleMesh& mesh, const Camera& camera,
                                             std::uint32_t width, std::uint32_t height);

}  // namespace crofton::cli
