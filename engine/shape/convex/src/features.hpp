// SPDX-License-Identifier: MIT
// Finds the part of a shape's surface that faces a direction: a polygon, a segment or a point, with ids.
#pragma once
#include <crofton/convex/query.hpp>

namespace crofton::convex {

inline constexpr int kMaxPatch = kMaxHullVertices;

// Points in the world's axes around the origin given; counter-clockwise seen from outside. Edge k leads from point k to
// the next.
struct Patch {
    int count = 0;
    glm::dvec3 normal{0.0};  // unit, outward; of segments and points the direction asked for; 0 of narrow polygons
    Feature self;            // the face, or of segments the edge, or of points the vertex
    glm::dvec3 point[kMaxPatch];
    std::uint16_t vertex[kMaxPatch], edge[kMaxPatch];
    const ShapeAtPose* of = nullptr;  // none: the points are all that is known
};

// From point k to the next, from the numbers of the shape: of a short edge the difference of the points is rounding.
[[nodiscard]] glm::dvec3 exact_edge(const Patch& patch, int k);

// Of the shape's core; the face most nearly across `direction` (unit, in the world).
void patch_along(const ShapeAtPose& placed, const glm::dvec3& direction, const glm::dvec3& origin, Patch& patch);

// The patch of one face of a hull, box or triangle. A box's face without width is a segment or a point, with the normal
// of the face.
void patch_of_face(const ShapeAtPose& placed, int face, const glm::dvec3& origin, Patch& patch);
// The same without its normal.
void corners_of_face(const ShapeAtPose& placed, int face, const glm::dvec3& origin, Patch& patch);

[[nodiscard]] inline bool has_same_id(const ContactPoint& p, const ContactPoint& q) {
    return p.on_a == q.on_a && p.on_b == q.on_b && p.part_a == q.part_a && p.part_b == q.part_b;
}

// The feature that the given vertices of a core span: a vertex, an edge, a face.
[[nodiscard]] Feature feature_of(const Shape& shape, const int* vertices, int count);

// Corner numbers of a box's face 2k + s, counter-clockwise from outside, and the edges between them.
inline constexpr std::uint8_t kBoxFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                                 {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

// Edge 4k + j: j numbers the corners with bit k clear, by their other two bits.
[[nodiscard]] constexpr std::uint16_t box_edge(int from, int to) {
    const int along = from ^ to, k = along == 1 ? 0 : along == 2 ? 1 : 2, low = from & to;
    const int j = (low >> ((k + 1) % 3) & 1) + 2 * (low >> ((k + 2) % 3) & 1);
    return static_cast<std::uint16_t>(4 * k + j);
}

// The unit normal of a shape's image under a rotation that is rigid to 1e-6 alone: the cofactors turn normals.
[[nodiscard]] glm::dvec3 turned_normal(const glm::dmat3& rotation, const glm::dvec3& normal);
// Whether a polygon's sides are too nearly parallel to clip another patch by them: a millionth of its length wide.
// Where they cross would be off along them by rounding over that angle. Its patch has the normal 0.
[[nodiscard]] bool is_narrow(const glm::dvec3* points, int count);
// Of a triangle's image, from its corners in the shape's frame, which are floats: rounded world coordinates would tilt
// that of a narrow one. 0 where the corners lie on a line.
[[nodiscard]] glm::dvec3 triangle_normal(const glm::dmat3& rotation, const Triangle& corners);

// The face of a polytope that looks most along a direction of the shape's frame; −1 where it has none.
[[nodiscard]] int face_along(const Shape& shape, const glm::dvec3& local);

}  // namespace crofton::convex
