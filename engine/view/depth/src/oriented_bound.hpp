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

// The aligned box, with its floats' rounding.
void set_bound(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices, glm::vec3& center,
               glm::vec3& half);

}  // namespace crofton::depth
