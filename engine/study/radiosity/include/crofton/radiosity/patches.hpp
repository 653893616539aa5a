// SPDX-License-Identifier: MIT
// Patches, which emit and receive light, and the form factors between them.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/lines/lines.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::radiosity {

// Patches: groups of triangles with one radiosity each.

// The material of a patch, per unit area and colour channel: its emitted radiosity, and the share of incoming light
// that it reflects.
struct Material {
    glm::vec3 emission{0.0f};
    glm::vec3 reflectance{0.5f};
};

// The patches of a scene. Light leaves and arrives on the front of a triangle (counter-clockwise side); the back
// absorbs it.
struct Patches {
    TriangleMesh mesh;
    Vector<std::uint32_t> patch_of_triangle;
    Vector<Material> materials;     // by patch
    Vector<double> areas;           // by patch
    Vector<double> triangle_areas;  // by triangle

    [[nodiscard]] std::size_t count() const { return materials.size(); }
};

// Makes patches. Errors name the patch or triangle: as validate(TriangleMesh); sizes that do not match; emission
// negative or not finite; reflectance outside [0, 1) (at 1 light would never end); a triangle without area; a patch
// without triangles.
[[nodiscard]] Result<Patches> make_patches(TriangleMesh mesh, std::span<const std::uint32_t> patch_of_triangle,
                                           std::span<const Material> materials);
// Makes each triangle its own patch.
[[nodiscard]] Result<Patches> make_patches(TriangleMesh mesh, std::span<const Material> materials);

// A refined mesh. `source` has, for each of its triangles, the triangle of the original mesh that contains it.
struct RefinedMesh {
    TriangleMesh mesh;
    Vector<std::uint32_t> source;
};

// Removes T-junctions: vertices of other triangles that lie within `tolerance` of a triangle's side become its corners.
//
// `triangulate` cuts the triangle into triangles of minimum weight, which use every such point. Sides that touched
// several others then match them end to end, so that refine() leaves no T-junctions. New vertices are copies of these
// vertices, with the triangle's own colours. Errors: as validate(TriangleMesh); a negative tolerance.
[[nodiscard]] Result<RefinedMesh> mend_t_junctions(const TriangleMesh& mesh, double tolerance);

// Halves edges until none is longer than `longest_edge`.
//
// Whether and where an edge is cut depends only on its end points, so triangles that share an edge are cut alike. If
// `mesh` has no T-junctions, the result has none, also across meshes. Errors: as validate(TriangleMesh); longest_edge
// not positive; more than `most_triangles` (budget_exceeded).
[[nodiscard]] Result<RefinedMesh> refine(const TriangleMesh& mesh, double longest_edge,
                                         std::size_t most_triangles = std::size_t{1} << 24);
// Does the same with a separate length for each place: `longest_edge` of the edge's midpoint.
using EdgeLength = FunctionRef<double(const glm::vec3& middle)>;
[[nodiscard]] Result<RefinedMesh> refine(const TriangleMesh& mesh, EdgeLength longest_edge,
                                         std::size_t most_triangles = std::size_t{1} << 24);

// Cuts triangles that contain the border of a sun shadow into four, `halvings` times. Shadows become 2^halvings times
// as sharp. The sides of neighbours are cut alike, so there are no new T-junctions.
//
// Seven points of each triangle that faces the sun are tested: near its corners, near the midpoints of its sides, and
// its center. A shadow ends in the triangle if some of them see the sun and others do not. Shadows that fit between
// these points are missed: call refine() first. `to_sun` may have any length. `mesh` itself blocks the sun, from either
// side. Errors: as refine() and lines::LineTracer::build; to_sun zero, too long to square or not finite.
[[nodiscard]] Result<RefinedMesh> refine_at_shadows(const TriangleMesh& mesh, const glm::dvec3& to_sun,
                                                    std::uint32_t halvings,
                                                    std::size_t most_triangles = std::size_t{1} << 24);

// Returns 1 for each triangle that faces the sun and whose center sees it, and 0 for the others. As labels for
// group_small_triangles they separate light and shadow. Errors: as refine_at_shadows.
[[nodiscard]] Result<Vector<std::uint32_t>> sunlit_triangles(const TriangleMesh& mesh, const glm::dvec3& to_sun);

// Do the same with an existing tracer of `mesh`, or of the mesh that it was cut from. The tracer's triangles block the
// sun.
[[nodiscard]] Result<RefinedMesh> refine_at_shadows(const lines::LineTracer& scene, const TriangleMesh& mesh,
                                                    const glm::dvec3& to_sun, std::uint32_t halvings,
                                                    std::size_t most_triangles = std::size_t{1} << 24);
[[nodiscard]] Result<Vector<std::uint32_t>> sunlit_triangles(const lines::LineTracer& scene, const TriangleMesh& mesh,
                                                             const glm::dvec3& to_sun);

// Returns a patch number for each triangle. Triangles of at least size²/4 are patches of their own. Smaller ones share
// a patch if they are in one cell of side `size`, face the same side of a cube and have the same label. `labels` has
// one per triangle, or is empty. Triangles that are too small for lines to hit are thus grouped.
[[nodiscard]] Vector<std::uint32_t> group_small_triangles(const TriangleMesh& mesh,
                                                          std::span<const std::uint32_t> labels, double size);

// Returns one colour per corner of every triangle (3·triangles): the area-weighted mean of `values` over the patches
// that share the corner's position and face within about 30 degrees of the triangle. `weights`, one per patch or none,
// multiply the areas; a corner without weight is 0.
[[nodiscard]] Vector<glm::vec3> corner_values(const Patches& patches, std::span<const glm::vec3> values,
                                              std::span<const double> weights = {});

// Form factors F_ij, the share of the light leaving patch i that reaches patch j first, estimated in three ways.

// The density of a local line's direction from its uniform point of the patch. The first two give the same factors, the
// first of them with less spread.
enum class LocalDensity : std::uint8_t {
    cosine,              // density cosθ/π, every line counts 1
    uniform,             // density 1/2π over the hemisphere, every line counts 2·cosθ (the paper's f₂)
    uniform_unweighted,  // deliberately wrong, for tests to reject: uniform directions that count 1
};

struct FactorRow {
    Vector<double> factors;          // by patch
    Vector<double> standard_errors;  // by patch
    double escaped = 0.0;            // the share that reaches nothing; 0 in closed scenes
    std::uint64_t lines = 0;
};

// Estimates row i from `lines` local lines, which start at triangles of the patch by area.
//
// A line that arrives at a back counts as absorbed: it reaches no patch and does not escape, so the row then sums to
// less than 1. Requires i < patches.count(), lines ≥ 1.
[[nodiscard]] FactorRow factors_by_local_lines(const lines::LineTracer& tracer, const Patches& patches, std::uint32_t i,
                                               std::uint64_t lines, LocalDensity density, std::uint64_t seed,
                                               sampling::Sequence sequence = sampling::Sequence::pseudo_random);

// All rows at once, from global lines. Every crossing of a line with a patch's front starts one ray there, for any
// shape of the patch. It counts crossings, not lines, so it is right for non-planar patches too (section 6.1 of the
// paper).
struct FactorMatrix {
    std::size_t size = 0;
    Vector<std::uint32_t> transfers;  // [i·size + j]: rays from i that reach j
    Vector<std::uint64_t> rays;       // by i
    Vector<std::uint64_t> escaped;    // by i
    std::uint64_t lines = 0;

    [[nodiscard]] double factor(std::size_t i, std::size_t j) const;
    [[nodiscard]] double standard_error(std::size_t i, std::size_t j) const;  // binomial: √(F(1−F)/rays)
};

// Estimates the full matrix. It takes size² counters: use it for small scenes, tests and studies; the solver never
// builds it. Errors: more than 16,384 patches.
[[nodiscard]] Result<FactorMatrix> factors_by_global_lines(const lines::LineTracer& tracer, const Patches& patches,
                                                           const lines::LineSource& source, std::uint64_t blocks,
                                                           Executor& executor = serial_executor());

// The values for a ray that reaches no patch's front.
inline constexpr std::uint32_t kSky = ~std::uint32_t{0};       // nothing
inline constexpr std::uint32_t kBack = ~std::uint32_t{0} - 1;  // the back of a triangle, which absorbs light

// Calls ray(i, j) for every ray that starts on the front of patch i along the line, in either direction. j is what the
// ray reaches first: a patch, kSky or kBack. Two fronts that face each other give ray(i, j) and ray(j, i).
template <class RayVisitor>
void for_each_ray(std::span<const lines::Hit> crossings, const Patches& patches, RayVisitor&& ray) {
    std::uint32_t before = kSky;  // patch whose front looks along the line into this stretch, or what is there instead
    for (const lines::Hit& hit : crossings) {
        const std::uint32_t here = patches.patch_of_triangle[hit.triangle];
        if (before < kBack) ray(before, hit.front ? here : kBack);
        if (hit.front) ray(here, before);
        before = hit.front ? kBack : here;
    }
    if (before < kBack) ray(before, kSky);
}

}  // namespace crofton::radiosity
