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

// An indexed triangle mesh, as plain data. Each triangle has three indices, counter-clockwise seen from outside.
// `colors` is empty or has one linear RGB per vertex.
struct TriangleMesh {
    Vector<glm::vec3> positions;
    Vector<std::uint32_t> indices;
    Vector<glm::vec3> colors;

    [[nodiscard]] std::size_t triangle_count() const { return indices.size() / 3; }
};

// Checks a mesh. Errors: a non-finite position, an index out of range, an index count that is not a multiple of three,
// a wrong number of colours; item = the first bad one. An empty mesh is valid here; functions that need triangles
// refuse it.
[[nodiscard]] Result<void> validate(const TriangleMesh& mesh);

// Appends the vertices and triangles of `part`. Colours are kept if all vertices of both have one, and dropped
// otherwise. Requires less than 2^32 vertices in total, and that `part` is not `mesh` itself.
void append(TriangleMesh& mesh, const TriangleMesh& part);

// A planar polygon with holes.
//
// `points` has the rings one after another. Ring r is [ring_ends[r−1], ring_ends[r]). The first ring is the outer one,
// the others are holes. The last point of a ring is joined to its first. Rings may have either orientation. Triangle
// indices refer to `points`.
struct Polygon {
    Vector<glm::dvec2> points;
    Vector<std::uint32_t> ring_ends;

    [[nodiscard]] std::size_t ring_count() const { return ring_ends.size(); }
    [[nodiscard]] std::span<const glm::dvec2> ring(std::size_t r) const {
        const std::size_t begin = r == 0 ? 0 : ring_ends[r - 1];
        return {points.data() + begin, ring_ends[r] - begin};
    }
};

// The convex hull of points in space.
struct ConvexHull {
    // The dimension of the set: 0 for a point, 1 for a segment, 2 for a planar polygon, 3 for a solid. Sets thinner
    // than 1e-12 of their size count as flat.
    int rank = 0;
    // Indices of the hull's corners into the input, each once; the first of equal points. Rank 0: one point; rank 1:
    // the two ends; rank 2: the polygon, in order around it; rank 3: ascending.
    Vector<std::uint32_t> vertices;
    // Rank 3: the triangulated faces, counter-clockwise seen from outside, as indices into the input. Otherwise empty.
    Vector<std::uint32_t> triangles;
};

// Computes the convex hull by Qhull (Barber, Dobkin and Huhdanpaa 1996), after dropping points that cannot be corners.
//
// It decides in rounded arithmetic: a point closer than about 1e-15 of the set's size to the hull's boundary may be
// dropped as an inner point. Errors: no points; more than 2^31; a point that is NaN, infinite or beyond kMaxCoordinate,
// with the first such index as the item.
[[nodiscard]] Result<ConvexHull> convex_hull(std::span<const glm::vec3> points);
[[nodiscard]] Result<ConvexHull> convex_hull(std::span<const glm::dvec3> points);

}  // namespace crofton
