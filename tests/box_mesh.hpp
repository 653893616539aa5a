// SPDX-License-Identifier: MIT
// Boxes as meshes.
#pragma once
#include <crofton/geometry/mesh.hpp>
#include <glm/vec3.hpp>

namespace crofton::testing {

// Eight vertices, x first, and twelve triangles, counter-clockwise from outside.
inline TriangleMesh box_mesh(const glm::vec3& low, const glm::vec3& high) {
    TriangleMesh mesh;
    for (unsigned i = 0; i < 8; ++i)
        mesh.positions.push_back({(i & 1u) ? high.x : low.x, (i & 2u) ? high.y : low.y, (i & 4u) ? high.z : low.z});
    mesh.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                    2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
    return mesh;
}

// [-half, half]³.
inline TriangleMesh cube_mesh(float half = 1.0f) {
    return box_mesh(glm::vec3(-half), glm::vec3(half));
}

}  // namespace crofton::testing
