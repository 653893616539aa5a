// The locally-minimal-triangulation skeleton: which candidates are surely in, which surely out.
#pragma once
#include "candidate_graph.hpp"

namespace crofton::triangulate {

// Dickerson, Keil and Montague (1997); Beirouti and Snoeyink (1998). In a minimum-weight triangulation every edge that
// is no constraint is the shorter diagonal of the two triangles beside it, or they form no convex quadrilateral; a flip
// crosses no constraint, so this holds under constraints as well. Ties go to the edge with the smaller vertex pair:
// that is the unique minimum for lengths with an infinitesimal added by rank, and a minimum for the lengths themselves.
class LmtSkeleton {
  public:
    // Sets kDead on edges without a pair of candidate triangles that makes them locally minimal, until none is left.
    void prune(std::span<const glm::dvec2> points, CandidateGraph& graph);
    // Sets kCertain on living edges that no living edge crosses. `mesh` is the constrained Delaunay triangulation that
    // the candidates of this graph, just pruned, come from.
    void mark_certain(const HalfEdgeMesh& mesh);

  private:
    struct Certificate {
        Index left = kNone, right = kNone;
    };
    struct Chord {
        Index half_edge, next;
    };

    [[nodiscard]] bool alive(Index h) const { return (graph_->flags[h] & CandidateGraph::kDead) == 0; }
    [[nodiscard]] bool certify(Index h);
    [[nodiscard]] bool locally_minimal(Index p, Index q, Index left, Index right) const;
    [[nodiscard]] bool shorter(Index a, Index b, Index p, Index q) const;
    void kill(Index h);
    void walk(Index h);
    void cross_within_triangles();

    std::span<const glm::dvec2> points_;
    const HalfEdgeMesh* mesh_ = nullptr;
    CandidateGraph* graph_ = nullptr;
    Vector<Index> origin_, stack_, stamp_, left_, right_;
    Vector<Certificate> certificates_;
    Vector<std::uint8_t> queued_, crossed_;
    Vector<Index> chord_head_;
    Vector<Chord> chords_;
    Index stamp_value_ = 0;
};

// Whether two candidates cross. They contain no vertex inside, so unless they share an end all sides are strict.
[[nodiscard]] bool candidates_cross(std::span<const glm::dvec2> points, Index a, Index b, Index c, Index d);

}  // namespace crofton::triangulate
