// SPDX-License-Identifier: MIT
// Makes shapes from numbers that are known to be valid, without checks and without rounding to float.
#pragma once
#include <crofton/convex/shape.hpp>
#include <glm/mat3x3.hpp>

namespace crofton::convex {

struct ShapeMaker {
    [[nodiscard]] static Shape triangle(const Triangle& corners);
    [[nodiscard]] static Shape sphere(double radius);
    [[nodiscard]] static Shape box(const glm::dvec3& half_extents);
    // A capsule along y. Requires 0 ≤ half_height and 0 ≤ radius, both finite.
    [[nodiscard]] static Shape capsule(double half_height, double radius);
    // The triangles of a mesh under a linear map: each vertex is multiplied by `*map`, in double. nullptr: no map.
    // `bounds` are around the mesh's own vertices. The map must stay alive, as the mesh must. Under a map that
    // flattens, each query visits all triangles.
    //
    // Serves overlap, distance, depth, manifolds and casts; rays need the mesh's own frame.
    [[nodiscard]] static Shape mesh(const mesh::MeshTree& mesh, const Aabb& bounds, const glm::dmat3* map);
    [[nodiscard]] static const glm::dmat3* map_of(const Shape& shape) { return shape.map_; }
};

}  // namespace crofton::convex
