// SPDX-License-Identifier: MIT
// Halving edges, whatever says which.
#pragma once
#include <crofton/radiosity/patches.hpp>

namespace crofton::radiosity::detail {

// Whether the edge between two positions is to be cut; the same for (a, b) and (b, a), and for every triangle.
using CutEdge = FunctionRef<bool(const glm::vec3& a, const glm::vec3& b)>;

// One round: every edge that is to be cut is halved, and each triangle cut into two to four. Requires a valid mesh.
// Triangles keep their order; source ascends. May throw std::bad_alloc.
[[nodiscard]] RefinedMesh cut_edges(const TriangleMesh& mesh, CutEdge is_cut);

}  // namespace crofton::radiosity::detail
