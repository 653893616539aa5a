// SPDX-License-Identifier: MIT
// The vertices of the rasterizer's static buffer, and how to add meshes.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/geometry/mesh.hpp>
#include <cstdint>
#include <glm/vec3.hpp>

namespace crofton::render {

struct Vertex {
    glm::vec3 position;
    glm::vec3 normal;
    glm::vec3 color;  // linear RGB
};

struct IndexRange {
    std::uint32_t first_index = 0;
    std::uint32_t index_count = 0;
};

// Appends a mesh's triangles, in order, with normals: faces that meet at a corner by less than `crease_angle_radians`
// share an area-weighted normal.
//
// Positions stay bit for bit, so triangle t of the mesh and triangle first_index / 3 + t of the buffer clip alike. A
// mesh without colours gets `color`. Requires validate(mesh), and totals below 2^32.
IndexRange append_mesh(const TriangleMesh& mesh, const glm::vec3& color, Vector<Vertex>& vertices,
                       Vector<std::uint32_t>& indices, float crease_angle_radians = 0.7f);

}  // namespace crofton::render
