// SPDX-License-Identifier: MIT
// A small box around a few triangles.
#pragma once
#include <crofton/depth/clustered_mesh.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::depth {

// Sets centre and half edges: of the aligned box, or of one along the triangles' mean normal where its surface is less.
// The box contains the triangles, its floats' rounding included.
void set_bound(Cluster& cluster, std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices);

// The aligned box alone.
void set_aligned_bound(Cluster& cluster, std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices);

}  // namespace crofton::depth
