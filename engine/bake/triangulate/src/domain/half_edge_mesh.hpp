// SPDX-License-Identifier: MIT
// Triangles as half-edges, and the constrained Delaunay triangulation built on them.
#pragma once
#include <crofton/core/memory.hpp>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>

namespace crofton::triangulate {

using Index = std::uint32_t;
inline constexpr Index kNone = ~Index{0};

// Half-edge e of triangle e / 4 runs from origin[e] to origin[next(e)] with the triangle on its left. Slot 3 of every
// four is unused, so that next and previous need no division. A half-edge on the convex hull has twin kNone.
[[nodiscard]] inline Index next(Index e) {
    return (e & 3u) == 2u ? e - 2u : e + 1u;
}
[[nodiscard]] inline Index previous(Index e) {
    return (e & 3u) == 0u ? e + 2u : e - 1u;
}

struct HalfEdgeMesh {
    std::span<const glm::dvec2> points;  // distinct
    Vector<Index> origin;
    Vector<Index> twin;
    Vector<Index> mark;         // 0, or what constrains this edge (the same on both half-edges)
    Vector<Index> vertex_edge;  // a half-edge leaving each vertex; for hull vertices the one along the hull

    [[nodiscard]] std::size_t triangle_count() const { return origin.size() / 4; }
    [[nodiscard]] Index destination(Index e) const { return origin[next(e)]; }
    [[nodiscard]] Index apex(Index e) const { return origin[previous(e)]; }
    // The next half-edge counter-clockwise about origin[e], or kNone behind the hull.
    [[nodiscard]] Index rotate(Index e) const { return twin[previous(e)]; }

    void link(Index e, Index f) {
        twin[e] = f;
        if (f != kNone) twin[f] = e;
    }
};

// Where inserting a constraint met another one.
struct Crossing {
    bool found = false;
    Index mark = 0;  // of the constraint that is crossed
};

// One side of the cavity that a constraint carves: chain edge i joins vertices[i] and vertices[i + 1].
struct CavityChain {
    struct Edge {
        Index inner;    // the half-edge inside the cavity, before
        Index outside;  // its twin
        Index mark;
        Index fresh;  // the half-edge inside the cavity, after
    };
    Vector<Index> vertices;
    Vector<Edge> edges;
};

// Scratch memory, kept between polygons.
struct DelaunayScratch {
    struct Base {
        Index low, high, half_edge;
    };
    CavityChain upper, lower;
    Vector<Index> cavity;  // triangles to reuse
    Vector<Base> bases;
};

// Origins and twins of the Delaunay triangulation of mesh.points, whose codes and order are SpatialOrder's: no
// triangles if all are collinear. O(n log n).
void delaunay(HalfEdgeMesh& mesh, std::span<const std::uint32_t> codes, DelaunayScratch& scratch);

// Makes segments unions of edges, one step at a time. The triangles that a segment crosses are replaced by constrained
// Delaunay ones (Anglada, "An improved incremental algorithm for constructing restricted Delaunay triangulations",
// 1997).
class ConstraintInserter {
  public:
    ConstraintInserter(HalfEdgeMesh& mesh, DelaunayScratch& scratch) : mesh_(mesh), scratch_(scratch) {}
    // Advances from a towards b up to the next vertex on the segment: returns the half-edge from a to that vertex, or
    // kNone with `crossing` filled.
    [[nodiscard]] Index advance(Index a, Index b, Crossing& crossing);

  private:
    [[nodiscard]] Index existing(Index a, Index b) const;
    [[nodiscard]] Index first_crossed(Index a, Index b, Index& through) const;
    [[nodiscard]] Index carve(Index a, Index b, Index crossed, Crossing& crossing);
    [[nodiscard]] Index fill(CavityChain& chain, Index* triangles);
    void reconnect(CavityChain& chain);
    void repair_vertex_edges();

    HalfEdgeMesh& mesh_;
    DelaunayScratch& scratch_;
};

}  // namespace crofton::triangulate
