// SPDX-License-Identifier: MIT
// The triangles of a mesh tree at a pose, as the exact tests use them.
#pragma once
#include <crofton/geometry/shapes.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/mesh_query.hpp>

namespace crofton::mesh {

[[nodiscard]] inline glm::dvec3 vertex_of(const mesh::MeshLeaf& leaf, std::uint32_t lane, int v) {
    return {static_cast<double>(leaf.vertex[v][0][lane]), static_cast<double>(leaf.vertex[v][1][lane]),
            static_cast<double>(leaf.vertex[v][2][lane])};
}

[[nodiscard]] inline Triangle triangle_of(const mesh::MeshLeaf& leaf, std::uint32_t lane) {
    return {vertex_of(leaf, lane, 0), vertex_of(leaf, lane, 1), vertex_of(leaf, lane, 2)};
}

[[nodiscard]] inline Triangle triangle_of(const mesh::MeshLeaf& leaf, std::uint32_t lane, const RigidTransform& pose) {
    return {transform(pose, vertex_of(leaf, lane, 0)), transform(pose, vertex_of(leaf, lane, 1)),
            transform(pose, vertex_of(leaf, lane, 2))};
}

}  // namespace crofton::mesh
