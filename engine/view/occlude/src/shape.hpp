// SPDX-License-Identifier: MIT
// A shape of occluders, prepared: vertices welded, edges with their triangles, connected pieces.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/occlude/occluder.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::occlude {

inline constexpr std::uint32_t kNone = ~std::uint32_t{0};

// From a to b as `left` has it, counter-clockwise around it; `right` goes from b to a. An edge of one triangle, or of
// more than two, or of two that go the same way, stands once for each of its triangles. It has no right triangle there.
struct ShapeEdge {
    std::uint32_t a, b;
    std::uint32_t left, right;
};

// Triangles [first_triangle, end_triangle) and edges likewise: what hangs together by edges that have two triangles.
struct ShapePiece {
    std::uint32_t first_triangle, end_triangle;
    std::uint32_t first_edge, end_edge;
};

// Three points of a face, counter-clockwise.
struct ShapeFace {
    std::uint32_t a, b, c;
};

struct Shape {
    Vector<glm::vec3> points;
    Vector<std::uint32_t> triangles;  // three points each, by pieces
    // By pieces. Of a convex shape: `left` and `right` are faces, and no edge lies within a face.
    Vector<ShapeEdge> edges;
    Vector<ShapeFace> faces;  // of a convex shape: triangles in exactly one plane are one face
    Vector<ShapePiece> pieces;
    Sides sides = Sides::front;
    bool convex = false;
    // A surface that is one piece, nearly flat, with a convex outline: the edges around it, each to the right of none.
    // Empty otherwise. Its widest triangle comes first.
    Vector<ShapeEdge> outline;
    float max_abs = 0.0f;  // ≥ |x|, |y|, |z| of every point

    [[nodiscard]] std::size_t triangle_count() const { return triangles.size() / 3; }
};

// Errors as OccluderSet's functions of these names.
[[nodiscard]] Result<Shape> convex_shape(std::span<const glm::vec3> points);
[[nodiscard]] Result<Shape> closed_shape(const TriangleMesh& mesh);
[[nodiscard]] Result<Shape> surface_shape(const TriangleMesh& surface, Sides sides);

}  // namespace crofton::occlude
