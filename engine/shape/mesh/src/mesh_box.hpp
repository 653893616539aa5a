// SPDX-License-Identifier: MIT
// The boxes of a mesh tree.
#pragma once
#include <cmath>
#include <crofton/core/memory.hpp>
#include <crofton/mesh/mesh_layout.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::mesh {

inline constexpr float kMaxMeshCoordinate = 1e12f;  // cubes of differences stay within float

[[nodiscard]] inline bool is_usable(const glm::vec3& p) {
    return std::abs(p.x) <= kMaxMeshCoordinate && std::abs(p.y) <= kMaxMeshCoordinate &&
           std::abs(p.z) <= kMaxMeshCoordinate;
}

class MeshBoxFitter {
  public:
    // Holds all the points, of which there is one at least, none beyond 1e12. The same bits on every machine.
    [[nodiscard]] MeshBox fit(std::span<const glm::vec3> points, MeshBoxes boxes);

  private:
    void turn(std::span<const glm::vec3> points, int axis, glm::dmat3& frame);

    Vector<float> u_, v_;  // coordinates across the axis of a turn
};

}  // namespace crofton::mesh
