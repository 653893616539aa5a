// SPDX-License-Identifier: MIT
// The kernels of MeshTree::refit.
#pragma once
#include <crofton/mesh/mesh_layout.hpp>
#include <cstddef>

namespace crofton::mesh {

// Gathers the positions, three floats each, of `count` leaves; returns the largest magnitude of a coordinate.
[[nodiscard]] float move_leaves(const float* positions, const LeafVertices* vertices, std::size_t count,
                                MeshLeaf* leaves);

// Turns the node's boxes and bounds the triangles of the leaves below each. The same bits on every instruction set.
void refit_boxes(const float* positions, const MeshLeaf* leaves, const BoxAnchors& anchors, MeshNode& node);

}  // namespace crofton::mesh
