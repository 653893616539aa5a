// SPDX-License-Identifier: MIT
// Surfaces that give and take light: triangles grouped into patches of one radiosity each.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/function_ref.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/triangle_mesh.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::radiosity {

// Per unit area and colour channel: radiosity given off by itself, and the share of what arrives that is given back.
struct Material {
    glm::vec3 emission{0.0f};
    glm::vec3 reflectance{0.5f};
};

// Light leaves and arrives on the front of a triangle (counter-clockwise side); the back swallows it.
struct Patches {
    TriangleMesh mesh;
    Vector<std::uint32_t> patch_of_triangle;
    Vector<Material> materials;     // by patch
    Vector<double> areas;           // by patch
    Vector<double> triangle_areas;  // by triangle

    [[nodiscard]] std::size_t count() const { return materials.size(); }
};

// Errors name the patch or triangle: as validate(TriangleMesh); sizes that do not match; emission negative or not
// finite; reflectance outside [0, 1) (at 1 light would never end); a triangle of no area; a patch without triangles.
[[nodiscard]] Result<Patches> make_patches(TriangleMesh mesh, std::span<const std::uint32_t> patch_of_triangle,
                                           std::span<const Material> materials);
// Every triangle its own patch.
[[nodiscard]] Result<Patches> make_patches(TriangleMesh mesh, std::span<const Material> materials);

// A mesh cut until no edge is longer than `longest_edge`, and for each of its triangles the one of `mesh` it lies in.
struct RefinedMesh {
    TriangleMesh mesh;
    Vector<std::uint32_t> source;
};

// Vertices of other triangles that lie within `tolerance` of a triangle's side become corners: the triangle is cut
// through `triangulate` into those of minimum weight, which use every such point. Sides that lay against several others
// then meet them end to end, so that refine() leaves no T-junctions. New vertices are copies of the ones met, their
// colours the triangle's own. Errors: as validate(TriangleMesh); tolerance negative.
[[nodiscard]] Result<RefinedMesh> mend_t_junctions(const TriangleMesh& mesh, double tolerance);

// Long edges are halved, round by round. Whether and where depends on an edge's end points alone, so triangles that
// share an edge are cut alike: where `mesh` has no T-junctions the result has none, also across meshes. Errors: as
// validate(TriangleMesh); longest_edge not positive; more than `most_triangles` (budget_exceeded).
[[nodiscard]] Result<RefinedMesh> refine(const TriangleMesh& mesh, double longest_edge,
                                         std::size_t most_triangles = std::size_t{1} << 24);
// The same with a length of its own for each place: `longest_edge` of an edge's middle.
using EdgeLength = FunctionRef<double(const glm::vec3& middle)>;
[[nodiscard]] Result<RefinedMesh> refine(const TriangleMesh& mesh, EdgeLength longest_edge,
                                         std::size_t most_triangles = std::size_t{1} << 24);

// A patch number for each triangle: those of at least size²/4 are patches of their own, smaller ones share one with
// their like in the same cell of side `size`: facing the same side of a cube, of one label (labels: by triangle, or
// empty). What is too small to be met by lines on its own is met together.
[[nodiscard]] Vector<std::uint32_t> group_small_triangles(const TriangleMesh& mesh,
                                                          std::span<const std::uint32_t> labels, double size);

// One colour per corner of every triangle (3·triangles): the area-weighted mean of `values` over the patches that meet
// at the corner's position and whose faces are within about 30 degrees of the triangle's; `weights`, one a patch or
// none, multiply the areas, and a corner of no weight is 0.
[[nodiscard]] Vector<glm::vec3> corner_values(const Patches& patches, std::span<const glm::vec3> values,
                                              std::span<const double> weights = {});

}  // namespace crofton::radiosity
