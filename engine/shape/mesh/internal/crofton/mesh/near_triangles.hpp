// SPDX-License-Identifier: MIT
// Finds the triangles of a mesh that may be near a box or a point, or above a point, by the mesh's tree.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/mesh/mesh_layout.hpp>
#include <span>

namespace crofton::mesh {

// One triangle of a leaf; true ends the search.
using TriangleVisitor = FunctionRef<bool(const MeshLeaf& leaf, std::uint32_t lane)>;

// `nodes` and `leaves` are those of a mesh tree with triangles.

// Calls `visit` for every triangle that is not surely farther than `margin` from the box, which stands in the mesh's
// frame with axes orthonormal to 1e-5. In the order of the tree: the same on every machine.
void visit_triangles_near(const MeshNode* nodes, const MeshLeaf* leaves, const MeshBox& box, float margin,
                          TriangleVisitor visit);

// Calls `visit` for triangles that may be nearer to the box than the root of `squared`, the visitor's to lessen;
// nearest boxes first. `margin` is how far the box may be from where it should be.
void visit_nearest_triangles(const MeshNode* nodes, const MeshLeaf* leaves, const MeshBox& box, float margin,
                             const double& squared, TriangleVisitor visit);

// A point in a mesh's frame, off by `error` at most.
struct NearPoint {
    float at[3];
    float error;
};
// Calls `visit` for triangles that may be the nearest to the point, or as near as the nearest, if they are not farther
// than the root of `squared`, the visitor's to lessen. The visitor takes whatever is nearer; its answer is not read.
void visit_nearest_triangles(const MeshNode* nodes, std::span<const MeshLeaf> leaves, const NearPoint& point,
                             const double& squared, TriangleVisitor visit);

// A ray along axes[2], and two axes across, orthonormal to 1e-5, in a mesh's frame. All points on the ray are off by
// `error` at most.
struct UpwardRay {
    float origin[3], axes[3][3];
    float error;
};
// One triangle that the ray may cross, surely or not; true ends the search.
using RayVisitor = FunctionRef<bool(const MeshLeaf& leaf, std::uint32_t lane, bool surely)>;
// Calls `visit` for every triangle that does not surely miss the ray. Returns whether `visit` ended the search.
bool visit_triangles_above(const MeshNode* nodes, std::span<const MeshLeaf> leaves, const UpwardRay& ray,
                           RayVisitor visit);

}  // namespace crofton::mesh
