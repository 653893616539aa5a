// SPDX-License-Identifier: MIT
// Convex hulls of points in space.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace crofton {

struct ConvexHull {
    // Dimension of the set: 0 a point, 1 a segment, 2 a planar polygon, 3 a solid. Sets thinner than 1e-12 of their
    // size count as flat.
    int rank = 0;
    // Indices of the hull's corners into the input, each once; of equal points the first. Rank 0: one; 1: the two ends;
    // 2: the polygon, in order around it; 3: ascending.
    Vector<std::uint32_t> vertices;
    // Rank 3: faces, triangulated, counter-clockwise seen from outside; indices into the input. Otherwise empty.
    Vector<std::uint32_t> triangles;
};

// By Qhull (Barber, Dobkin and Huhdanpaa 1996), after points that cannot be corners have been dropped. Decided in
// rounded arithmetic: points within about 1e-15 of the set's size of the hull's boundary may be taken for inner ones.
// Errors: no points, more than 2^31; NaN, infinite or beyond kMaxCoordinate, with the first such index as the item.
[[nodiscard]] Result<ConvexHull> convex_hull(std::span<const glm::vec3> points);
[[nodiscard]] Result<ConvexHull> convex_hull(std::span<const glm::dvec3> points);

}  // namespace crofton
