// SPDX-License-Identifier: MIT
// Surfaces that give and take light, and how much of it goes from one to another.
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

// Surfaces that give and take light: triangles grouped into patches of one radiosity each.

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

// Vertices of other triangles that lie within `tolerance` of a triangle's side become corners. `triangulate` cuts the
// triangle into those of minimum weight, which use every such point. Sides that lay against several others then meet
// them end to end, so that refine() leaves no T-junctions. New vertices are copies of the ones met, their colours the
// triangle's own. Errors: as validate(TriangleMesh); tolerance negative.
[[nodiscard]] Result<RefinedMesh> mend_t_junctions(const TriangleMesh& mesh, double tolerance);

// Long edges are halved, round by round. Whether and where depends on an edge's end points alone, so triangles that
// share an edge are cut alike. Where `mesh` has no T-junctions the result has none, also across meshes. Errors: as
// validate(TriangleMesh); longest_edge not positive; more than `most_triangles` (budget_exceeded).
[[nodiscard]] Result<RefinedMesh> refine(const TriangleMesh& mesh, double longest_edge,
                                         std::size_t most_triangles = std::size_t{1} << 24);
// The same with a length of its own for each place: `longest_edge` of an edge's middle.
using EdgeLength = FunctionRef<double(const glm::vec3& middle)>;
[[nodiscard]] Result<RefinedMesh> refine(const TriangleMesh& mesh, EdgeLength longest_edge,
                                         std::size_t most_triangles = std::size_t{1} << 24);

// Triangles in which a shadow of the sun ends are cut into four, so many times: shadows are 2^halvings times as sharp
// then. The neighbours' sides are cut alike, so no T-junctions come about. Seven points of each triangle that faces the
// sun are looked from: near its corners, near the middles of its sides, and its center. A shadow ends there if some see
// the sun and others do not. What fits between these points is not found: refine() first. `to_sun`: of any length. What
// blocks the sun is `mesh` itself, from either side. Errors: as refine() and lines::LineTracer::build; to_sun zero, too
// long to square or not finite.
[[nodiscard]] Result<RefinedMesh> refine_at_shadows(const TriangleMesh& mesh, const glm::dvec3& to_sun,
                                                    std::uint32_t halvings,
                                                    std::size_t most_triangles = std::size_t{1} << 24);

// By triangle, 1 where it faces the sun and its center sees it. As labels for group_small_triangles they part light
// and shadow. Errors: as refine_at_shadows.
[[nodiscard]] Result<Vector<std::uint32_t>> sunlit_triangles(const TriangleMesh& mesh, const glm::dvec3& to_sun);

// The same where a tracer is at hand: of `mesh`, or of what it was cut from. What blocks the sun is the tracer's.
[[nodiscard]] Result<RefinedMesh> refine_at_shadows(const lines::LineTracer& scene, const TriangleMesh& mesh,
                                                    const glm::dvec3& to_sun, std::uint32_t halvings,
                                                    std::size_t most_triangles = std::size_t{1} << 24);
[[nodiscard]] Result<Vector<std::uint32_t>> sunlit_triangles(const lines::LineTracer& scene, const TriangleMesh& mesh,
                                                             const glm::dvec3& to_sun);

// A patch number for each triangle. Those of at least size²/4 are patches of their own. Smaller ones share one if they
// are in one cell of side `size`, face the same side of a cube and have the same label. `labels`: by triangle, or
// empty. What is too small to be met by lines on its own is met together.
[[nodiscard]] Vector<std::uint32_t> group_small_triangles(const TriangleMesh& mesh,
                                                          std::span<const std::uint32_t> labels, double size);

// One colour per corner of every triangle (3·triangles). It is the area-weighted mean of `values` over the patches that
// meet at the corner's position and face within about 30 degrees of the triangle. `weights`, one a patch or none,
// multiply the areas; a corner of no weight is 0.
[[nodiscard]] Vector<glm::vec3> corner_values(const Patches& patches, std::span<const glm::vec3> values,
                                              std::span<const double> weights = {});

// Form factors F_ij: the share of what leaves patch i that reaches patch j first, estimated three ways.

// How a local line leaves its uniform point of the patch. Both give the same factors, the first with less spread.
enum class LocalDensity : std::uint8_t {
    cosine,              // density cosθ/π, every line counts 1
    uniform,             // density 1/2π over the hemisphere, every line counts 2·cosθ (the paper's f₂)
    uniform_unweighted,  // wrong on purpose, for tests to reject: uniform directions that count 1
};

struct FactorRow {
    Vector<double> factors;          // by patch
    Vector<double> standard_errors;  // by patch
    double escaped = 0.0;            // the share that reaches nothing; 0 in closed scenes
    std::uint64_t lines = 0;
};

// Row i from `lines` local lines, from triangles of the patch by area. A line that arrives at a back counts as
// swallowed. It reaches no patch and does not escape, so the row then sums to less than 1. Requires i <
// patches.count(), lines ≥ 1.
[[nodiscard]] FactorRow factors_by_local_lines(const lines::LineTracer& tracer, const Patches& patches, std::uint32_t i,
                                               std::uint64_t lines, LocalDensity density, std::uint64_t seed,
                                               sampling::Sequence sequence = sampling::Sequence::pseudo_random);

// All rows at once from global lines. Every crossing of a patch's front with a line starts one ray there, whatever the
// patch's shape. Crossings are counted, not lines, so non-planar patches are right too (the paper's section 6.1).
struct FactorMatrix {
    std::size_t size = 0;
    Vector<std::uint32_t> transfers;  // [i·size + j]: rays from i that reach j
    Vector<std::uint64_t> rays;       // by i
    Vector<std::uint64_t> escaped;    // by i
    std::uint64_t lines = 0;

    [[nodiscard]] double factor(std::size_t i, std::size_t j) const;
    [[nodiscard]] double standard_error(std::size_t i, std::size_t j) const;  // binomial: √(F(1−F)/rays)
};

// The full matrix takes size² counters: for small scenes, tests and studies; the solver never builds it.
// Errors: more than 16,384 patches.
[[nodiscard]] Result<FactorMatrix> factors_by_global_lines(const lines::LineTracer& tracer, const Patches& patches,
                                                           const lines::LineSource& source, std::uint64_t blocks,
                                                           Executor& executor = serial_executor());

// What a ray meets that reaches no patch's front.
inline constexpr std::uint32_t kSky = ~std::uint32_t{0};       // nothing
inline constexpr std::uint32_t kBack = ~std::uint32_t{0} - 1;  // the back of a triangle, which swallows light

// Calls ray(i, j) for every ray that starts on the front of patch i along the line, either way. j is what the ray
// reaches first: a patch, kSky or kBack. Two fronts that face each other give ray(i, j) and ray(j, i).
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
