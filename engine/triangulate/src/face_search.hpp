// Faces whose boundary the certain edges leave in pieces: holes and isolated vertices that hang in the air.
#pragma once
#include "faces.hpp"
#include "interval_program.hpp"
#include "lmt_skeleton.hpp"

namespace crofton::triangulate {

struct SearchBudget;

// At a corner of more than a half-turn every triangulation has an edge on the inner side of either of its sides' lines,
// for the triangle at that side spans less than a half-turn. Where all candidates there lead to other pieces, one of
// these few edges is in the optimum: each in turn becomes certain, what crosses it dies, the skeleton is recomputed,
// and the faces that remain are solved separately, in the same way. Every choice joins two pieces, which bounds the
// depth.
class FaceSearch {
  public:
    enum class Outcome : std::uint8_t { solved, infeasible, gave_up };
    static constexpr std::size_t kMostPieces = 48;

    // Triangulates the face that walk or isolated vertex `name` of `faces` stands for. Appends triangles as half-edges
    // of `graph` and all diagonals inside.
    [[nodiscard]] Outcome solve(std::span<const glm::dvec2> points, const CandidateGraph& graph, const Faces& faces,
                                Index name, SearchBudget& budget, Vector<std::array<Index, 3>>& triangles,
                                Vector<Segment>& diagonals);

  private:
    // One face on its own: its vertices, its edges and their state.
    struct Level {
        CandidateGraph graph;
        Vector<glm::dvec2> points;
        Vector<Index> outer_half_edge, outer_vertex;  // the names one level up
        LmtSkeleton::Certificates certificates, working_certificates;
        Vector<Index> witness;       // per half-edge: a candidate that crosses it, if known
        Vector<std::uint8_t> flags;  // of the current branching, before the choice
        Faces faces;
        std::size_t pieces = 0;
        Vector<Index> choices;
        Vector<std::array<Index, 3>> triangles, best_triangles;
        Vector<Segment> diagonals, best_diagonals;
    };

    [[nodiscard]] Outcome solve_level(std::size_t depth, SearchBudget& budget);
    [[nodiscard]] Outcome solve_choice(std::size_t depth, Index choice, SearchBudget& budget);
    [[nodiscard]] Outcome solve_rest(std::size_t depth, SearchBudget& budget);
    void extract(std::span<const glm::dvec2> points, const CandidateGraph& graph, const Faces& faces, Index name,
                 Level& level);
    void choose(Level& level);
    void mark_certain(Level& level) const;
    [[nodiscard]] bool has_crossing(Level& level, Index h) const;
    void raise(const Level& level, Vector<std::array<Index, 3>>& triangles, Vector<Segment>& diagonals) const;

    Vector<Level> levels_;
    LmtSkeleton skeleton_;
    IntervalProgram program_;
    RootSums sums_;
    Vector<Index> members_, option_, dead_;
};

// How much searching is left; shared by all faces of a polygon.
struct SearchBudget {
    std::uint64_t choices = 0;
    [[nodiscard]] bool spend() { return choices != 0 && choices-- != 0; }
};

}  // namespace crofton::triangulate
