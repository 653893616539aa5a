// SPDX-License-Identifier: MIT
// The planar polygons hidden in a triangle mesh, found and triangulated anew.
#pragma once
#include <crofton/geometry/triangle_mesh.hpp>
#include <crofton/triangulate/triangulate.hpp>
#include <span>
#include <string>

namespace crofton::triangulate {

// What a vertex carries besides its position: texture coordinates, normals, colours, displacements. Triangles
// interpolate it, so a flat area is one patch only as far as it is one linear function of the position there, up to
// `tolerance` at every vertex (in the values' units; NaN agrees with nothing). Its interpolated value then changes
// nowhere by more than 2 · tolerance. What is not interpolated linearly (bones and their weights) must be `constant`
// over a patch.
struct VertexValues {
    std::span<const float> values;  // `components` a vertex
    std::size_t components = 0;
    double tolerance = 0.0;
    bool constant = false;
};

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
// all remain in use, and the number of triangles is the same. A patch whose new triangles would not all face as before
// (rounding, at collinear vertices) or cover another area (where the patch overlaps itself) is left alone. Errors: as
// find_planar_patches, cancelled.
[[nodiscard]] Result<PatchReport> retriangulate_planar_patches(TriangleMesh& mesh, const PatchOptions& options = {});

}  // namespace crofton::triangulate
