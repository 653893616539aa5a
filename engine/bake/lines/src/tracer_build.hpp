// SPDX-License-Identifier: MIT
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/geometry/mesh.hpp>
#include <glm/vec3.hpp>

#include "trace_kernels.hpp"

namespace crofton::lines::detail {

// Eight-way tree over the mesh's triangles, positions relative to `origin`. nodes[0] is the root. The mesh is valid and
// not empty.
void build_tracer(const TriangleMesh& mesh, const glm::dvec3& origin, Vector<mesh::BoxNode>& nodes,
                  Vector<TracerLeaf>& leaves);

}  // namespace crofton::lines::detail
