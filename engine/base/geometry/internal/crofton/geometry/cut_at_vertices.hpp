// SPDX-License-Identifier: MIT
// T-junctions on lines along the axes: triangles cut at the vertices on their sides, exactly.
#pragma once
#include <array>
#include <crofton/core/memory.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace crofton {

// Cuts triangles from their corners to the vertices on their sides along an axis, up to four times as many as there
// were. No vertex is new, so that what is cut covers the same points exactly. Triangles with two equal corners, and
// those with all corners on one line along an axis, are left out. Requires finite positions, each once, and indices in
// range.
[[nodiscard]] Vector<std::array<std::uint32_t, 3>> cut_at_vertices(
    std::span<const glm::vec3> positions, std::span<const std::array<std::uint32_t, 3>> triangles);

}  // namespace crofton
