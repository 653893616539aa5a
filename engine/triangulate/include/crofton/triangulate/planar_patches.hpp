// The planar polygons hidden in a triangle mesh, found and triangulated anew.
#pragma once
#include <crofton/geometry/triangle_mesh.hpp>
#include <crofton/triangulate/triangulate.hpp>
#include <span>

namespace crofton::triangulate {

// Triangles that hang together by shared sides (pairs of vertex indices, so seams of any vertex attribute separate
// them) and lie in one plane, facing the same way.
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
    Options triangulation;
};

// What became of one patch.
struct PatchResult {
    Vector<std::uint32_t> triangles;  // of the mesh, as in PlanarPatch; their indices are the new ones
    std::size_t vertices = 0, holes = 0;
    double weight_before = 0.0, weight_after = 0.0;
    bool optimal = false;  // weight_after is proven minimal
    double gap = 0.0;      // as in Triangulation
    double microseconds = 0.0;
};

struct PatchReport {
    std::size_t patches = 0;    // of two or more triangles
    std::size_t improved = 0;   // that became lighter
    std::size_t triangles = 0;  // in patches
    std::size_t unproven = 0;   // patches whose weight is not proven minimal, or that could not be triangulated
    double weight_before = 0.0, weight_after = 0.0;  // of all patches
    Vector<PatchResult> results;                     // in the order of their first triangles
};

// All patches of two or more triangles, in the order of their first triangles. Triangles without area and sides shared
// by more than two triangles belong to no patch and join nothing. Errors: as validate(mesh).
[[nodiscard]] Result<Vector<PlanarPatch>> find_planar_patches(const TriangleMesh& mesh, double tolerance = 0.0);

// Replaces the triangles of each patch by those of its polygon where that makes it lighter. Vertices stay as they are,
// all remain in use, and the number of triangles is the same. A patch whose new triangles would not all face as before
// (rounding, at collinear vertices) is left alone. Errors: as validate(mesh), cancelled.
[[nodiscard]] Result<PatchReport> retriangulate_planar_patches(TriangleMesh& mesh, const PatchOptions& options = {});

}  // namespace crofton::triangulate
