// SPDX-License-Identifier: MIT
// Finds the triangles that a minimum-weight triangulation may use: those whose neighbours support them on all sides.
#pragma once
#include "minimum_weight/candidate_graph.hpp"
#include "watch.hpp"

namespace crofton::triangulate {

// The LMT skeleton taken from edges to triangles. In a minimum-weight triangulation every side of a triangle that is no
// constraint has a triangle of the same triangulation beyond it, and is locally minimal between the two. So a triangle
// that lacks such a partner among the living ones on any side is in none, and dies. An edge without living triangles on
// both sides dies with them. Where a certificate of an edge may use a left and a right triangle that no triangulation
// could hold together with their own neighbours, this rule follows such chains to where they break.
class TriangleSupport {
  public:
    // The living triangles on the left of each half-edge.
    struct Lists {
        struct Entry {
            Index next;     // the half-edge after this one in the triangle
            Index support;  // the `next` of a living triangle beyond this half-edge with which it is locally minimal
        };
        struct Range {
            Index begin, size;
        };
        Vector<Range> ranges;
        Vector<Entry> entries;
    };

    // Lists the triangles of living edges, but for those in faces that are outside or simple, and sets kDead on edges
    // that no living triangle has. Returns false if some certain edge has no triangle left: then there is no
    // triangulation. Stops early with the watch or at `limit` entries, which is right but prunes less; `lists` are then
    // of no use.
    [[nodiscard]] bool build(std::span<const glm::dvec2> points, CandidateGraph& graph, std::size_t limit, Watch& watch,
                             Lists& lists);
    // The same after some half-edges (one of each edge) have died, given the lists from before.
    [[nodiscard]] bool update(std::span<const Index> dead, std::span<const glm::dvec2> points, CandidateGraph& graph,
                              Watch& watch, Lists& lists);

  private:
    struct Side {
        Index next, vertex, support;
    };

    void start(std::span<const glm::dvec2> points, CandidateGraph& graph, Lists& lists);
    [[nodiscard]] bool list_triangles(std::size_t limit, Watch& watch);
    void collect_sides(Index h);
    template <int kTurn, class Admit>
    void scan(Index h, Admit admit) const;
    void support_sides(Index h);
    void store(Index h, const Vector<Side>& side);
    void drop_incomplete(Watch& watch);
    [[nodiscard]] bool run(Watch& watch);
    void check(Index h);
    [[nodiscard]] bool find_support(Index h, Lists::Entry& entry) const;
    void remove_triangle(Index h, Index next);
    void remove_entry(Index h, Index next);
    void kill(Index h);
    [[nodiscard]] bool alive(Index h) const { return (graph_->flags[h] & CandidateGraph::kDead) == 0; }
    [[nodiscard]] bool fixed(Index h) const { return (graph_->flags[h] & CandidateGraph::kFixed) != 0; }
    [[nodiscard]] bool left_inside(Index h) const {
        return (graph_->flags[h] & (CandidateGraph::kLeftOutside | CandidateGraph::kLeftSimple)) == 0;
    }
    [[nodiscard]] Index origin(Index h) const { return graph_->destination[graph_->twin[h]]; }
    [[nodiscard]] Index edge_between(Index from, Index to) const;
    [[nodiscard]] std::span<Lists::Entry> entries(Index h) const {
        const auto& range = lists_->ranges[h];
        return std::span(lists_->entries).subspan(range.begin, range.size);
    }

    std::span<const glm::dvec2> points_;
    CandidateGraph* graph_ = nullptr;
    Lists* lists_ = nullptr;
    Vector<Side> left_, right_;
    Vector<Index> leaving_;   // per vertex, the half-edge to it from the vertex in turn
    Vector<Index> admitted_;  // per vertex, the last half-edge whose lower end saw an empty triangle to it
    Vector<Index> stack_;
    Vector<std::uint8_t> queued_;
    bool feasible_ = true;
};

}  // namespace crofton::triangulate
