// SPDX-License-Identifier: MIT
// Makes bodies from numbers that are known to be good, without checks and without rounding to float.
#pragma once
#include <crofton/convex/body.hpp>
#include <glm/mat3x3.hpp>

namespace crofton::convex {

struct BodyMaker {
    [[nodiscard]] static Body triangle(const Triangle& corners);
    [[nodiscard]] static Body sphere(double radius);
    [[nodiscard]] static Body box(const glm::dvec3& half_extents);
    // A capsule along y. Requires 0 ≤ half_height and 0 ≤ radius, both finite.
    [[nodiscard]] static Body capsule(double half_height, double radius);
    // The triangles of a mesh under a linear map: each vertex is multiplied by `*map`, in double. nullptr: no map.
    // `bounds` are around the mesh's own vertices. The map must stay alive, as the mesh must. Under a map that
    // flattens, each query visits all triangles.
    //
    // Serves overlap, distance, depth, manifolds and casts; rays need the mesh's own frame.
    [[nodiscard]] static Body mesh(const mesh::MeshTree& mesh, const Aabb& bounds, const glm::dmat3* map);
    [[nodiscard]] static const glm::dmat3* map_of(const Body& body) { return body.map_; }
};

}  // namespace crofton::convex
