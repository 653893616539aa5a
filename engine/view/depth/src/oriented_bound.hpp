// SPDX-License-Identifier: MIT
// A small box around a few triangles.
#pragma once
#include <crofton/depth/clustered_mesh.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::depth {

// Returns the aligned box, or one along the triangles' mean normal where its surface is less. It contains the triangles
// exactly.
[[nodiscard]] ClusteredMesh::PackedBox bound_of(std::span<const glm::vec3> positions,
                                                std::span<const std::uint32_t> indices);

// Proves that a box contains the vertices. True for each that bound_of() has made of them; never true of one that does
// not contain them. Of other turned boxes, those that fit by a few roundings may fail.
[[nodiscard]] bool contains(const ClusteredMesh::PackedBox& box, std::span<const glm::vec3> vertices);
[[nodiscard]] bool contains(const ClusterBox& aligned, std::span<const glm::vec3> vertices);

// The aligned box, with its floats' rounding.
void set_bound(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices, glm::vec3& center,
               glm::vec3& half);

}  // namespace crofton::depth
