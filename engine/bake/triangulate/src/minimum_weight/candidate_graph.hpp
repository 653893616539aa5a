// SPDX-License-Identifier: MIT
// The edges that a minimum-weight triangulation may use, in angular order about each vertex.
#pragma once
#include <crofton/core/memory.hpp>

#include "domain/domain.hpp"
#include "watch.hpp"

namespace crofton::triangulate {

// Half-edges of vertex v are [first[v], first[v + 1]), counter-clockwise. All boundary edges, slits and those visible
// pairs of vertices that pass the diamond test (docs/notes/triangulate.md proves it under constraints).
struct CandidateGraph {
    enum Flag : std::uint8_t {
        kConstraint = 1,   // boundary or slit: in every triangulation
        kLeftOutside = 2,  // the polygon's outside lies on its left
        kDelaunay = 4,     // an edge of the constrained Delaunay triangulation
        kCertain = 8,      // proven to be in a minimum-weight triangulation
        kDead = 16,        // proven to be in none
        kLeftSimple = 32,  // a face that needs no further pruning lies on its left or around it
    };
    static constexpr std::uint8_t kFixed = kConstraint | kCertain;
    Vector<Index> first;
    Vector<Index> destination;
    Vector<Index> twin;
    Vector<std::uint8_t> flags;
    Vector<Index>
        input;  // the caller's index at the origin; empty if every vertex has one index, which is then input_of

    [[nodiscard]] std::size_t vertex_count() const { return first.size() - 1; }
    [[nodiscard]] std::size_t half_edge_count() const { return destination.size(); }
};

// Finds the candidates by looking from every vertex through the constrained Delaunay triangulation.
class CandidateFinder {
  public:
    // False if more than `limit` half-edges would be needed or the watch stops; the graph is then unusable.
    [[nodiscard]] bool find(const Domain& domain, std::size_t limit, Watch& watch, CandidateGraph& graph);

  private:
    // The view from a vertex through mesh half-edge `edge`, between the directions of two visible vertices. The two
    // witnesses are visible vertices on or beyond these directions that may rule out everything farther away.
    struct View {
        Index edge, right, left, right_witness, left_witness;
    };
    struct Seen {
        Index vertex;
        std::uint8_t flags;
        Index input;
    };

    void look_from(Index p);
    void look_through(Index edge, Index right, Index left);
    [[nodiscard]] bool is_dark(View& view) const;
    void filter(std::size_t begin, std::size_t end);
    [[nodiscard]] bool match_twins(CandidateGraph& graph, Watch& watch);

    const Domain* domain_ = nullptr;
    const HalfEdgeMesh* mesh_ = nullptr;
    Index from_ = 0;
    glm::dvec2 eye_{};
    Vector<View> views_;
    Vector<Seen> seen_;
    Vector<glm::dvec2> vectors_;
    Vector<Index> pending_origin_, pending_head_, stamp_, renumbered_;
};

}  // namespace crofton::triangulate
