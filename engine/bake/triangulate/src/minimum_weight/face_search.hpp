// SPDX-License-Identifier: MIT
// Faces whose boundary the certain edges leave in pieces: holes and isolated vertices that hang in the air.
#pragma once
#include "minimum_weight/faces.hpp"
#include "minimum_weight/interval_program.hpp"
#include "minimum_weight/triangle_support.hpp"
#include "numbers/root_sums.hpp"
#include "watch.hpp"

namespace crofton::triangulate {

// At a corner of more than a half-turn every triangulation has an edge on the inner side of either of its sides' lines,
// for the triangle at that side spans less than a half-turn. Where all candidates there lead to other pieces, one of
// these few edges is in the optimum: each in turn becomes certain, what crosses it dies, the skeleton is recomputed,
// and the faces that remain are solved separately, in the same way. Every choice joins two pieces, which bounds the
// depth.
class FaceSearch {
  public:
    // `unproven`: time ran out after a triangulation was found; `gave_up`: it ran out before, or there are more pieces
    // than the depth allows.
    enum class Outcome : std::uint8_t { solved, unproven, infeasible, gave_up };
    static constexpr std::size_t kMostPieces = 48;

    // Triangulates the face that walk or isolated vertex `name` of `faces` stands for. Appends triangles as half-edges
    // of `graph` and all diagonals inside.
    [[nodiscard]] Outcome solve(std::span<const glm::dvec2> points, const CandidateGraph& graph, const Faces& faces,
                                Index name, Watch& watch, Vector<std::array<Index, 3>>& triangles,
                                Vector<Segment>& diagonals);

  private:
    // One face on its own: its vertices, its edges and their state.
    struct Level {
        CandidateGraph graph;
        Vector<glm::dvec2> points;
        Vector<Index> outer_half_edge, outer_vertex;  // the names one level up
        TriangleSupport::Lists lists, working_lists;
        Vector<Index> witness;       // per half-edge: a candidate that crosses it, if known
        Vector<std::uint8_t> flags;  // of the current branching, before the choice
        Faces faces;
        Vector<Index> choices;
        Vector<std::array<Index, 3>> triangles, best_triangles;
        Vector<Segment> diagonals, best_diagonals;
    };

    [[nodiscard]] Outcome solve_level(std::size_t depth, Watch& watch);
    [[nodiscard]] Outcome solve_choice(std::size_t depth, Index choice, Watch& watch);
    [[nodiscard]] Outcome solve_rest(std::size_t depth, Watch& watch);
    void extract(std::span<const glm::dvec2> points, const CandidateGraph& graph, const Faces& faces, Index name,
                 Level& level);
    void choose(Level& level);
    // Returns false if the watch stops.
    [[nodiscard]] bool mark_certain(Level& level, Watch& watch) const;
    [[nodiscard]] bool has_crossing(Level& level, Index h, std::size_t& steps) const;
    [[nodiscard]] Index crossing_from_apex(const Level& level, Index h) const;
    void raise(const Level& level, Vector<std::array<Index, 3>>& triangles, Vector<Segment>& diagonals) const;

    Vector<Level> levels_;
    TriangleSupport support_;
    IntervalProgram program_;
    RootSums sums_;
    Vector<Index> members_, option_, dead_;
};

}  // namespace crofton::triangulate
