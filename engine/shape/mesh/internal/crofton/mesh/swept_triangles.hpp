// SPDX-License-Identifier: MIT
// Finds the triangles of a mesh that a moving box reaches.
#pragma once
#include <crofton/mesh/near_triangles.hpp>

namespace crofton::mesh {

// A box with rounded edges, in the mesh's frame.
struct RoundedBox {
    MeshBox core;  // axes orthonormal to 1e-5
    float radius;
    float error;  // how far the shape may be from there, and how much is to be left around it
};
// A rounded box that moves along a line and does not turn: at s it stands as `box`, moved by s · way.
struct SweptBox {
    RoundedBox box;
    float way[3];    // of length 1
    float from, to;  // the part of the way, in lengths
};

// Calls `visit` for every triangle that the shape may come within its `error` of at some s from `swept.from` up to
// `limit`, about the first first. `limit` is the visitor's to lessen, and at most `swept.to`. The order, and which
// triangles come that could be left out, are those of the machine. `nodes` and `leaves` are those of a mesh tree with
// triangles.
void visit_swept_triangles(const MeshNode* nodes, const MeshLeaf* leaves, const SweptBox& swept, const float& limit,
                           TriangleVisitor visit);

// The same of a box that stands still, in the order of the tree.
void visit_triangles_near(const MeshNode* nodes, const MeshLeaf* leaves, const RoundedBox& box, TriangleVisitor visit);

}  // namespace crofton::mesh
