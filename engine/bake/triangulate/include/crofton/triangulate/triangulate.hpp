// SPDX-License-Identifier: MIT
// Polygons with holes to triangles of minimum weight; the planar patches of meshes.
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

// Polygons with holes to triangles: minimum weight, because that is what a frustum pays for (theory.md section 5).

enum class Method : std::uint8_t { ear, delaunay, minimum_weight };

// Limits of the exact search for the minimum weight. Where one is reached, the lightest of three triangulations is
// returned, with `optimal` false and a proven `gap`. One completes what is proven so far to a constrained Delaunay
// triangulation; the others are those of Method::delaunay and Method::ear. Each is improved by flips and by exact
// minima of windows of fifty triangles. They are linear, and not counted. All but the largest and smoothest polygons
// (docs/triangulate.md) need a small part.
struct TriangulateOptions {
    static constexpr std::uint64_t kUnlimitedWork = ~std::uint64_t{0};
    // Enough for nearly all polygons: 10^9 steps, or where there are more than 20,000 points 50,000 for each, but no
    // more than 10^10. No limit where `seconds` is one: the time that is given is used.
    static constexpr std::uint64_t kAutomaticWork = kUnlimitedWork - 1;

    Method method = Method::minimum_weight;
    // In elementary steps of the search, of some 10 ns each: the same answer on every machine, however busy.
    std::uint64_t work = kAutomaticWork;
    // By the clock: the answer depends on the machine. Infinite or above 1e9 is no limit.
    double seconds = std::numeric_limits<double>::infinity();
    // Of the candidates' memory.
    std::size_t bytes = std::size_t{1} << 30;
    // Once it returns true, the call ends with the error `cancelled`.
    StopCallback should_stop = nullptr;
    void* user = nullptr;
};

// Triangles hold indices into polygon.points, counter-clockwise. Conforming: every vertex is used, collinear ones too,
// and no vertex lies in the interior of a triangle's side. The triangles' areas add up to the polygon's.
struct Triangulation {
    Vector<std::array<std::uint32_t, 3>> triangles;
    double weight = 0.0;   // total length of the diagonals
    bool optimal = false;  // weight is proven minimal
    double gap = 0.0;      // proven bound on (weight − minimum) / minimum, 0 when optimal, infinity when unknown
};

// What input means that is not a simple polygon with disjoint simple holes inside it:
// - a point is inside a ring if an odd number of the ring's edges lie between it and infinity. Rings may touch
//   themselves and each other, at points or along edges;
// - points at one position are one vertex. Triangles name the index of the ring whose corner they fill, on either side
//   of a slit its own. Of consecutive duplicates they name the first, or the ring's first point if that is one of them;
// - a vertex on another edge splits that edge;
// - an edge that one ring traverses there and back is no boundary. A spike pointing inside becomes a slit that
//   triangles do not cross. One pointing outside vanishes and its tip is used by no triangle;
// - a hole of one point is a Steiner point, of two a slit, of none nothing.
// Errors name ring, point and position: an outer ring of fewer than three points; positions not finite or differing by
// more than 2^200 in size; edges that cross; holes outside, overlapping or nested; zero area.
[[nodiscard]] Result<Triangulation> triangulate(const Polygon& polygon, const TriangulateOptions& options = {});

// The same with memory kept between calls: allocates nothing once its buffers fit the largest polygon seen.
class Triangulator {
  public:
    Triangulator();
    ~Triangulator();
    Triangulator(Triangulator&&) noexcept;
    Triangulator& operator=(Triangulator&&) noexcept;

    // On error `result` is empty.
    [[nodiscard]] Result<void> triangulate(const Polygon& polygon, const TriangulateOptions& options,
                                           Triangulation& result);

  private:
    struct Workspace;
    struct Release {
        void operator()(Workspace* workspace) const;
    };
    std::unique_ptr<Workspace, Release> workspace_;
};

// The planar polygons hidden in a triangle mesh, found and triangulated anew.

// What a vertex carries besides its position: texture coordinates, normals, colours, displacements. Triangles
// interpolate it, so a flat area is one patch only where it is one linear function of the position. It may be off by
// `tolerance` at every vertex, in the values' units; NaN agrees with nothing. Its interpolated value then changes
// nowhere by more than 2 · tolerance. What is not interpolated linearly (bones and their weights) must be `constant`
// over a patch.
struct VertexValues {
    std::span<const float> values;  // `components` a vertex
    std::size_t components = 0;
    double tolerance = 0.0;
    bool constant = false;
};

// Triangles that hang together by shared sides and lie in one plane, facing the same way. A side is a pair of vertex
// indices, so seams of any vertex attribute separate triangles.
struct PlanarPatch {
    Vector<std::uint32_t> triangles;  // of the mesh, ascending
    Polygon polygon;                  // outer ring first; a vertex inside the patch is a ring of one point
    Vector<std::uint32_t> vertices;   // polygon point → vertex of the mesh
    double weight = 0.0;              // of the inner sides as they are
};

struct PatchOptions {
    // The distance from the plane of a patch's first triangle up to which vertices count as in it, in the mesh's units;
    // 0 means exactly.
    double tolerance = 0.0;
    std::span<const VertexValues> values;
    TriangulateOptions triangulation;
};

// What became of one patch.
struct PatchResult {
    Vector<std::uint32_t> triangles;  // of the mesh, as in PlanarPatch; their indices are the new ones
    std::size_t vertices = 0, holes = 0;
    double weight_before = 0.0, weight_after = 0.0;
    bool optimal = false;  // weight_after is proven minimal
    double gap = 0.0;      // as in Triangulation
    double microseconds = 0.0;
    std::string refused;  // why it could not be triangulated anew and stays as it was; empty where it could
};

struct PatchReport {
    std::size_t patches = 0;                         // of two or more triangles
    std::size_t improved = 0;                        // that became lighter
    std::size_t triangles = 0;                       // in patches
    std::size_t refused = 0;                         // that could not be triangulated anew
    std::size_t unproven = 0;                        // whose weight is not proven minimal, the refused among them
    double weight_before = 0.0, weight_after = 0.0;  // of all patches
    Vector<PatchResult> results;                     // in the order of their first triangles
};

// All patches of two or more triangles, in the order of their first triangles. Triangles without area and sides shared
// by more than two triangles belong to no patch and join nothing. Errors: as validate(mesh); values of another number
// than vertices times components.
[[nodiscard]] Result<Vector<PlanarPatch>> find_planar_patches(const TriangleMesh& mesh, double tolerance = 0.0,
                                                              std::span<const VertexValues> values = {});

// Replaces the triangles of each patch by those of its polygon where that makes it lighter. Vertices stay as they are,
// all remain in use, and the number of triangles is the same. A patch is left alone if its new triangles would not all
// face as before (rounding, at collinear vertices). So is one that overlaps itself, since they would cover
// another area. Errors: as find_planar_patches, cancelled.
[[nodiscard]] Result<PatchReport> retriangulate_planar_patches(TriangleMesh& mesh, const PatchOptions& options = {});

}  // namespace crofton::triangulate
