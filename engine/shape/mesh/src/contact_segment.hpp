// SPDX-License-Identifier: MIT
// Computes the common segment of two triangles if it is known which edges pass through which triangle.
#pragma once
#include <crofton/mesh/mesh_query.hpp>
#include <cstdint>
#include <glm/geometric.hpp>

namespace crofton::mesh {

// As long as twice the area.
[[nodiscard]] inline glm::dvec3 scaled_normal(const Triangle& t) {
    return glm::cross(t[1] - t[0], t[2] - t[0]);
}

// contact_segment(a, b), to the bit, without asking for exact signs: `edges` are those of PairVisitor. 0: not known.
[[nodiscard]] SegmentOfContact contact_segment(const Triangle& a, const Triangle& b, std::uint32_t edges);

}  // namespace crofton::mesh
