// SPDX-License-Identifier: MIT
// Triangulation of polygons with holes, and of the planar patches of meshes.
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/core/stop.hpp>
#include <crofton/geometry/mesh.hpp>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>

namespace crofton::triangulate {

// Polygons with holes to triangles, by default of minimum weight, which is what frusta pay for (docs/theory.md, section
// 5).

enum class Method : std::uint8_t { ear, delaunay, minimum_weight };

// Limits of the exact search for the minimum weight.
//
// If one is reached, the lightest of three triangulations is returned, with `optimal` false and a proved `gap`. One
// completes the proved part to a constrained Delaunay triangulation; the others are those of Method::delaunay and
// Method::ear. Each is improved by flips and by exact minima of windows of fifty triangles. These steps take linear
// time, which no limit counts. All but the largest and smoothest polygons (docs/triangulate.md) need a small part of
// the limits.
struct TriangulateOptions {
    static constexpr std::uint64_t kUnlimitedWork = ~std::uint64_t{0};
    // The default, enough for nearly all polygons: 10^9 steps; above 20,000 points 50,000 per point, but no more than
    // 10^10. No limit if `seconds` is set.
    static constexpr std::uint64_t kAutomaticWork = kUnlimitedWork - 1;

    Method method = Method::minimum_weight;
    // Elementary steps of the search, of some 10 ns each. The answer is the same on every machine, however busy.
    std::uint64_t work = kAutomaticWork;
    // Elapsed time. The answer depends on the machine. Infinity or above 1e9 means no limit.
    double seconds = std::numeric_limits<double>::infinity();
    // Memory of the candidates.
    std::size_t bytes = std::size_t{1} << 30;
    // If it returns true, the call ends with the error `cancelled`.
    StopCallback should_stop = nullptr;
    void* user = nullptr;
};

// A triangulation. Triangles have indices into polygon.points, counter-clockwise.
//
// It is conforming: every vertex is used, collinear ones too, and no vertex lies in the interior of a triangle's side.
// The triangles' areas add up to the polygon's.
struct Triangulation {
    Vector<std::array<std::uint32_t, 3>> triangles;
    double weight = 0.0;   // total length of the diagonals
    bool optimal = false;  // the weight is proved minimal
    double gap = 0.0;      // proved bound of (weight − minimum) / minimum; 0 if optimal, infinity if unknown
};

// Triangulates a polygon. Input that is not a simple polygon with disjoint simple holes is interpreted as follows:
// - A point is inside a ring if an odd number of the ring's edges lie between it and infinity. Rings may touch
//   themselves and each other, at points or along edges.
// - Points at one position are one vertex. Triangles use the index of the ring whose corner they fill; on either side
//   of a slit they use that side's own index. Of consecutive duplicates they use the first, or the ring's first point
//   if it is one of them.
// - A vertex on another edge splits that edge.
// - An edge that one ring traverses in both directions is not a boundary. A spike that points inside becomes a slit
//   that triangles do not cross. A spike that points outside vanishes, and no triangle uses its tip.
// - A hole of one point is a Steiner point, a hole of two points a slit, a hole of no points nothing.
//
// Errors name ring, point and position: an outer ring of fewer than three points; positions that are not finite or
// differ by more than 2^200 in size; edges that cross; holes that lie outside, overlap or are nested; zero area.
[[nodiscard]] Result<Triangulation> triangulate(const Polygon& polygon, const TriangulateOptions& options = {});

// Triangulates polygons and keeps its memory between calls. Allocates nothing once its buffers fit the largest polygon
// so far.
class Triangulator {
  public:
    Triangulator();
    ~Triangulator();
    Triangulator(Triangulator&&) noexcept;
    Triangulator& operator=(Triangulator&&) noexcept;

    // On an error, `result` is empty.
    [[nodiscard]] Result<void> triangulate(const Polygon& polygon, const TriangulateOptions& options,
                                           Triangulation& result);

  private:
    struct Workspace;
    struct Release {
        void operator()(Workspace* workspace) const;
    };
    std::unique_ptr<Workspace, Release> workspace_;
};

// Finding the planar polygons in a triangle mesh, and triangulating them again.

// An attribute of the vertices: texture coordinates, normals, colours, displacements.
//
// Triangles interpolate it, so a flat area is one patch only if the attribute is one linear function of the position.
// It may deviate by `tolerance` at every vertex, in the values' units; the interpolated value then changes nowhere by
// more than 2 · tolerance. NaN agrees with nothing. An attribute that is not interpolated linearly (bones and their
// weights) must be `constant` over a patch.
struct VertexValues {
    std::span<const float> values;  // `components` per vertex
    std::size_t components = 0;
    double tolerance = 0.0;
    bool constant = false;
};

// Triangles that are connected by shared sides, lie in one plane, and face the same way. A side is a pair of vertex
// indices, so seams of any vertex attribute separate triangles.
struct PlanarPatch {
    Vector<std::uint32_t> triangles;  // of the mesh, ascending
    Polygon polygon;                  // outer ring first; a vertex inside the patch is a ring of one point
    Vector<std::uint32_t> vertices;   // polygon point → vertex of the mesh
    double weight = 0.0;              // of the present inner sides
};

struct PatchOptions {
    // The largest distance of a vertex from the plane of the patch's first triangle, in the mesh's units. 0 means
    // exactly in the plane.
    double tolerance = 0.0;
    std::span<const VertexValues> values;
    TriangulateOptions triangulation;
};

// The result for one patch.
struct PatchResult {
    Vector<std::uint32_t> triangles;  // of the mesh, as in PlanarPatch; their indices are the new ones
    std::size_t vertices = 0, holes = 0;
    double weight_before = 0.0, weight_after = 0.0;
    bool optimal = false;  // weight_after is proven minimal
    double gap = 0.0;      // as in Triangulation
    double microseconds = 0.0;
    std::string refused;  // why it could not be triangulated and stays unchanged; empty if it could
};

struct PatchReport {
    std::size_t patches = 0;                         // of two or more triangles
    std::size_t improved = 0;                        // became lighter
    std::size_t triangles = 0;                       // in patches
    std::size_t refused = 0;                         // could not be triangulated
    std::size_t unproven = 0;                        // weight not proved minimal, refused ones included
    double weight_before = 0.0, weight_after = 0.0;  // of all patches
    Vector<PatchResult> results;                     // in the order of their first triangles
};

// Finds all patches of two or more triangles, in the order of their first triangles. Triangles without area, and sides
// shared by more than two triangles, belong to no patch and connect nothing.
//
// Errors: as validate(mesh); a number of values other than vertices times components.
[[nodiscard]] Result<Vector<PlanarPatch>> find_planar_patches(const TriangleMesh& mesh, double tolerance = 0.0,
                                                              std::span<const VertexValues> values = {});

// Replaces the triangles of each patch by those of its polygon if these are lighter.
//
// It keeps all vertices, uses all of them, and keeps the number of triangles. A patch stays unchanged if its new
// triangles would not all keep their facing (rounding, at collinear vertices), or if it overlaps itself, because they
// would cover another area. Errors: as find_planar_patches, cancelled.
[[nodiscard]] Result<PatchReport> retriangulate_planar_patches(TriangleMesh& mesh, const PatchOptions& options = {});

}  // namespace crofton::triangulate
