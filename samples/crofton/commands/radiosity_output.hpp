// SPDX-License-Identifier: MIT
// Scenes into patches, and lit patches into files.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/radiosity/solver.hpp>
#include <optional>
#include <string>

#include "assets/flat_scene.hpp"
#include "json/json.hpp"

namespace crofton::cli {

// Patches, and what their triangles look like for themselves.
struct LitScene {
    radiosity::Patches patches;  // its mesh's colours are the reflectance at each corner
    Vector<glm::vec3> emission;  // by triangle
};

inline constexpr float kMostReflectance = 0.9f;  // of white paint; light must end

// How sharp shadows of the sun are to be: refine_at_shadows.
struct SunEdges {
    glm::dvec3 to_sun;
    std::uint32_t halvings = 3;
};

// T-junctions mended, edges of at most `edge` metres, small triangles in groups of that size. edge = 0: such
// that the scene has up to a few times its triangles, 50,000 at least, and longer far from where most of them are.
// Without `sun` shadows are as sharp as that. Groups lie in the sun or in its shadow.
[[nodiscard]] Result<LitScene> lit_scene(const assets::FlatScene& scene, double edge,
                                         const std::optional<SunEdges>& sun);

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

// Errors over patches that are lit in the reference. A patch's error is that of all channels together, relative to its
// light.
struct ReferenceReport {
    std::uint64_t runs = 0;
    double reference_error = 0.0;             // relative_error() of the reference
    double within_10 = 0.0, beyond_25 = 0.0;  // shares of patches, by number, in percent of their own light
    double median = 0.0, worst_of_95 = 0.0;   // errors that half and 95 % of the patches do not exceed
};

// Makes `runs` of another seed, and compares. Errors: as Solver::create; cancelled, if interrupted.
[[nodiscard]] Result<ReferenceReport> compare_to_reference(const radiosity::Patches& patches,
                                                           radiosity::SolverOptions options, std::uint64_t runs,
                                                           const radiosity::Solver& found, Executor& executor);

[[nodiscard]] Json to_json(const ReferenceReport& report);
void print(const ReferenceReport& report);

}  // namespace crofton::cli
