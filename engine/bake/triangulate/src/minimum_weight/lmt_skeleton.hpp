// SPDX-License-Identifier: MIT
// The locally-minimal-triangulation skeleton: which candidates are surely in, which surely out.
#pragma once
#include "minimum_weight/candidate_graph.hpp"
#include "watch.hpp"

namespace crofton::triangulate {

// Dickerson, Keil and Montague (1997); Beirouti and Snoeyink (1998). In a minimum-weight triangulation every edge that
// is no constraint is the shorter diagonal of its two triangles, or they form no convex quadrilateral. A flip
// crosses no constraint, so this holds under constraints as well. Ties go to the edge with the smaller vertex pair.
// That is the unique minimum for lengths with an infinitesimal added by rank, and a minimum for the lengths themselves.
class LmtSkeleton {
  public:
    // Sets kDead on edges without a certificate, that is, common neighbours on both sides that make them locally
    // minimal, until none is left. Stops early, which is right but prunes less, with the watch.
    void prune(std::span<const glm::dvec2> points, CandidateGraph& graph, Watch& watch);
    // Sets kCertain on living edges that no living edge crosses, but for those in simple faces. `mesh` is the
    // constrained Delaunay triangulation that the candidates of this graph, the last one pruned, come from.
    // Returns false, with nothing set, if the watch stops.
    [[nodiscard]] bool mark_certain(const HalfEdgeMesh& mesh, CandidateGraph& graph, Watch& watch);

  private:
    struct Certificate {
        Index left = kNone, right = kNone;
    };
    struct Chord {
        Index half_edge, next;
    };

    [[nodiscard]] bool alive(Index h) const { return (graph_->flags[h] & CandidateGraph::kDead) == 0; }
    void look_around(Index p, Watch& watch);
    void stamp(Index p);
    [[nodiscard]] bool certify(Index h);
    [[nodiscard]] Index origin(Index h) const { return graph_->destination[graph_->twin[h]]; }
    void find_delaunay();
    void cross_delaunay(Index h, Index crossing);
    template <class Visit>
    void walk(Index h, Visit visit) const;
    [[nodiscard]] bool cross_chords(Watch& watch);
    [[nodiscard]] bool cross_lonely_chords(Watch& watch);
    [[nodiscard]] bool is_chord(Index h) const;

    std::span<const glm::dvec2> points_;
    const HalfEdgeMesh* mesh_ = nullptr;
    CandidateGraph* graph_ = nullptr;
    Vector<Certificate> certificates_;
    Vector<Index> stamp_, common_, left_, right_;
    Vector<std::uint8_t> changed_, crossed_;
    static constexpr Index kEmptyList = kNone - 1;
    Vector<Index> graph_edge_, lonely_, chord_head_;
    Vector<Chord> chords_;
    Index stamp_value_ = 0;
};

}  // namespace crofton::triangulate
