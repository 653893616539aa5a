// SPDX-License-Identifier: MIT
// Scenes into patches, and lit patches into files.
#pragma once
#include <crofton/geometry/camera.hpp>
#include <crofton/radiosity/solver.hpp>
#include <string>

#include "assets/flat_scene.hpp"

namespace crofton::cli {

// Patches, and what their triangles look like for themselves.
struct LitScene {
    radiosity::Patches patches;  // its mesh's colours are the reflectance at each corner
    Vector<glm::vec3> emission;  // by triangle
};

inline constexpr float kMostReflectance = 0.9f;  // of white paint; light must end

// T-junctions mended, edges of at most `edge` metres, small triangles in groups of that size. edge = 0: such
// that the scene has up to a few times its triangles, 50,000 at least, and longer far from where most of them are.
[[nodiscard]] Result<LitScene> lit_scene(const assets::FlatScene& scene, double edge);

// Three vertices a triangle, whose colours are what leaves there: emission + reflectance · irradiance. Irradiance is
// interpolated between patches, the reflectance is each triangle's own.
[[nodiscard]] TriangleMesh lit_mesh(const LitScene& scene, const radiosity::Solver& solver);

// The factor that makes the scene's middle mid-grey: it brings the area's mean logarithm of light to 0.3.
[[nodiscard]] float automatic_exposure(const LitScene& scene, const radiosity::Solver& solver);

// Light into display-linear colours, such that highlights keep some shape.
[[nodiscard]] glm::vec3 compressed(const glm::vec3& light);

// Binary glTF with vertex colours and an unlit material (KHR_materials_unlit), in pieces that culling can tell apart.
[[nodiscard]] Result<void> write_glb(const std::string& path, const TriangleMesh& mesh);

// One picture of the unlit mesh through the rasterizer, as PNG. `sky`: how bright the background is.
[[nodiscard]] Result<void> write_lit_picture(const std::string& path, const TriangleMesh& mesh, const Camera& camera,
                                             std::uint32_t width, std::uint32_t height, float sky);

}  // namespace crofton::cli
