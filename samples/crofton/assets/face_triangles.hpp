// SPDX-License-Identifier: MIT
// Polygonal faces in space as triangles.
#pragma once
#include <array>
#include <crofton/triangulate/triangulate.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace crofton::assets {

// How a face was cut.
enum class FaceCut : std::uint8_t {
    convex,        // a fan from its first corner
    triangulated,  // by crofton::triangulate: the lightest triangulation, of more than 256 corners a Delaunay one
    no_polygon     // a fan from its first corner, because its outline crosses itself or encloses no area
};

// Keeps its memory between faces.
class FaceTriangulator {
  public:
    // Cuts a face of at least three corners. triangles() then hold indices into `corners`, each facing as the face
    // does. The face is projected along its Newell normal, so that it need not be planar. A hole may be reached by a
    // bridge (a keyhole): the bridge's two sides are one edge that bounds nothing. Spikes vanish, rings may touch. If
    // the outline crosses itself only by what coordinates were rounded, corners that lie on a side cut it in two.
    [[nodiscard]] FaceCut cut(std::span<const glm::dvec3> corners);
    [[nodiscard]] std::span<const std::array<std::uint32_t, 3>> triangles() const { return result_.triangles; }

  private:
    void fan(std::size_t corners);
    [[nodiscard]] bool is_convex() const;
    [[nodiscard]] bool triangulate();
    [[nodiscard]] bool weld_and_triangulate();

    triangulate::Triangulator triangulator_;
    triangulate::Triangulation result_;
    Polygon polygon_;
    std::vector<glm::dvec3> scaled_;
    std::vector<std::uint32_t> corner_of_;  // by point of a welded outline
};

}  // namespace crofton::assets
