// SPDX-License-Identifier: MIT
// An indexed triangle mesh, as plain data.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <cstdint>
#include <glm/vec3.hpp>

namespace crofton {

// Three indices a triangle, counter-clockwise seen from outside. `colors` is empty or holds one linear RGB per vertex.
struct TriangleMesh {
    Vector<glm::vec3> positions;
    Vector<std::uint32_t> indices;
    Vector<glm::vec3> colors;

    [[nodiscard]] std::size_t triangle_count() const { return indices.size() / 3; }
};

// Errors: non-finite position, index out of range, index count not a multiple of three, colour count; item = first
// culprit. An empty mesh is valid here; who needs triangles says so.
[[nodiscard]] Result<void> validate(const TriangleMesh& mesh);

}  // namespace crofton
