// SPDX-License-Identifier: MIT
// The point of a mesh that is nearest to a point.
#pragma once
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>

namespace crofton::mesh {

// As `distance` from a mesh that is that point alone: on_b is the point. The distance is 0 iff the point lies on a
// triangle, exactly so while its coordinates are 0 or at least 1e-70 in size; else it is off by 1e-12 of the
// coordinates' size. Infinite for a mesh without triangles and for a point that is not finite. Allocates nothing.
[[nodiscard]] MeshDistance distance_to_point(const MeshTree& mesh, const glm::dvec3& point);

}  // namespace crofton::mesh
