// SPDX-License-Identifier: MIT
// The triangles of a mesh that may be near a box, by the mesh's tree.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/mesh/mesh_layout.hpp>

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

}  // namespace crofton::mesh
