// SPDX-License-Identifier: MIT
// Uses one triangle in place of the box of its leaf.
#pragma once
#include <crofton/mesh/mesh_layout.hpp>

namespace crofton::mesh {

// Holds triangle `lane` of the leaf, whatever its shape; axes orthonormal to 1e-6, one across the triangle.
[[nodiscard]] mesh::MeshBox triangle_box(const mesh::MeshLeaf& leaf, std::uint32_t lane);

// Writes the unit vector from the nearest point of the triangle to `point`; zero where it contains the point.
void direction_from_triangle(const float (&corner)[3][4], const float* point, float* way);

}  // namespace crofton::mesh
