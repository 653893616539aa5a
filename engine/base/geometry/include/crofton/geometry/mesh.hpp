// SPDX-License-Identifier: MIT
// Triangle meshes, polygons with holes, convex hulls.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>

namespace crofton {

// An indexed triangle mesh, as plain data.
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

// Adds the part's vertices and triangles behind those of `mesh`. Colours are kept if all vertices of both have one,
// else dropped. Requires less than 2^32 vertices together, and that `part` is not `mesh` itself.
void append(TriangleMesh& mesh, const TriangleMesh& part);

// A planar polygon with holes.
// Rings one after another in `points`; ring r is [ring_ends[r−1], ring_ends[r]), the first is the outer one, the others
// holes. Rings are closed implicitly and may have either orientation; triangle indices refer to `points`.
struct Polygon {
    Vector<glm::dvec2> points;
    Vector<std::uint32_t> ring_ends;

    [[nodiscard]] std::size_t ring_count() const { return ring_ends.size(); }
    [[nodiscard]] std::span<const glm::dvec2> ring(std::size_t r) const {
        const std::size_t begin = r == 0 ? 0 : ring_ends[r - 1];
        return {points.data() + begin, ring_ends[r] - begin};
    }
};

// Convex hulls of points in space.
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
