// SPDX-License-Identifier: MIT
// All triangles of a scene as one surface: which of them meet at which sides, and in which order around them.
#pragma once
#include <array>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/mesh.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

#include "box_groups.hpp"

namespace crofton::pvs {

// Triangles without T-junctions on lines along the axes (cut_at_vertices): of equal positions one is kept, and sides
// that end at the same two are one. Triangles without an area are left out.
struct Surface {
    struct Face {
        std::array<std::uint32_t, 3> corners{};
        std::array<std::uint32_t, 3> edges{};   // from corner k to the next
        std::array<std::uint32_t, 3> spokes{};  // where it is in the list of that edge
    };
    struct Edge {
        std::uint32_t from = 0, to = 0;
        std::uint32_t first = 0, count = 0;  // its spokes
    };
    // Counter-clockwise around from → to, seen from `to`. The front of a face that runs along the edge is turned that
    // way on, that of one which runs against it is turned back. Proofs are right for any order: see surface_cut.hpp.
    struct Spoke {
        std::uint32_t face = 0;
        bool along = false;
    };

    Vector<glm::dvec3> positions;
    Vector<Face> faces;
    Vector<Edge> edges;
    Vector<Spoke> spokes;
    Vector<Aabb> bounds;            // of faces
    std::optional<BoxGroups> tree;  // of these; none without faces

    [[nodiscard]] std::array<glm::dvec3, 3> triangle(std::uint32_t face) const {
        const auto& c = faces[face].corners;
        return {positions[c[0]], positions[c[1]], positions[c[2]]};
    }
};

// Requires a valid mesh.
[[nodiscard]] Surface surface_of(const TriangleMesh& mesh);

}  // namespace crofton::pvs
