// SPDX-License-Identifier: MIT
// Cuts the triangles of a mesh into groups by expected cost.
#pragma once
#include <crofton/core/memory.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::depth {

struct Groups {
    Vector<std::uint32_t> order;  // triangles, group after group
    Vector<std::uint32_t> ends;   // of the groups, in `order`
};

// Requires at least one triangle and most ≥ 1.
[[nodiscard]] Groups cut_into_groups(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                                     std::uint32_t most);

}  // namespace crofton::depth
