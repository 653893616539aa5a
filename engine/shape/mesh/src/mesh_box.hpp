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

// Directions of many points are chosen by at least `kSample` of them, which stand this far apart.
inline constexpr std::size_t kSample = 128;
[[nodiscard]] constexpr std::size_t sample_step(std::size_t count) {
    return count < 2 * kSample ? 1 : count / kSample;
}

class MeshBoxFitter {
  public:
    // Returns a box of all the points, of which there is one at least, none beyond 1e12. Its axes are chosen by a
    // sample of them, or by all. The same bits on every machine.
    [[nodiscard]] MeshBox fit(std::span<const glm::vec3> points, MeshBoxes boxes, bool by_all = false);

  private:
    void turn(std::span<const glm::vec3> points, int axis, glm::dmat3& frame);

    Vector<glm::vec3> sample_;
    Vector<float> u_, v_;  // coordinates across the axis of a turn
};

}  // namespace crofton::mesh
