// SPDX-License-Identifier: MIT
// Klincsek's interval dynamic programme, over candidate edges only.
#pragma once
#include <array>
#include <crofton/core/memory.hpp>
#include <span>

#include "minimum_weight/candidate_graph.hpp"
#include "minimum_weight/interval_choice.hpp"
#include "watch.hpp"

namespace crofton::triangulate {

// Minimum-weight triangulations of faces: closed walks along certain half-edges with the face on their left and nothing
// but candidate edges inside. Two passes. The first computes the least weight over every candidate in double, with a
// bound on its rounding. The second (IntervalChoice) goes down from the root through the alternatives that the bound
// leaves, which are few, and decides between them exactly.
class IntervalProgram {
  public:
    void start(std::span<const glm::dvec2> points, const CandidateGraph& graph);

    // `walk` holds each corner's outgoing half-edge, in order. Returns the weight of the edges inside, or infinity if
    // the candidates triangulate no such face or the watch stops. The walk must have at least three corners and must
    // outlive append().
    [[nodiscard]] double solve(std::span<const Index> walk, Watch& watch, double fraction);
    // The same for a strictly convex ring of all diagonals, given by its vertices.
    [[nodiscard]] double solve_convex(std::span<const glm::dvec2> points, std::span<const Index> ring, Watch& watch,
                                      double fraction);
    // The memory that solve_convex() takes for so many vertices.
    [[nodiscard]] static std::size_t convex_bytes(std::size_t count);
    // Calls visit(low, middle, high) for the triangles of the last solve: positions in the walk or ring.
    template <class Visit>
    void for_each_triangle(Visit visit) const {
        choice_.for_each_triangle(visit);
    }
    // Appends the triangles of the last solve, as half-edges of the graph whose origins are their corners, and the
    // edges inside.
    void append(Vector<std::array<Index, 3>>& triangles, Vector<Segment>& diagonals) const;

  private:
    void collect_slots(std::span<const Index> walk);
    void match_targets();
    [[nodiscard]] double run(Watch& watch, double fraction);
    [[nodiscard]] double least_sum(Index begin, Index end) const;

    std::span<const glm::dvec2> points_;
    const CandidateGraph* graph_ = nullptr;
    std::span<const Index> walk_;
    IntervalTable table_;
    IntervalChoice choice_;
    Vector<Index> slot_of_, slot_edge_;
    // The values of the corner in turn's edges, by target; infinite where it has no edge.
    Vector<double> row_;
};

}  // namespace crofton::triangulate
