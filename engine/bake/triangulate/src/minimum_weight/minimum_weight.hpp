// SPDX-License-Identifier: MIT
// Exact minimum-weight triangulation of a domain: candidates, LMT skeleton, interval programmes, branching.
#pragma once
#include <crofton/triangulate/triangulate.hpp>

#include "minimum_weight/arc_bound.hpp"
#include "minimum_weight/face_search.hpp"
#include "minimum_weight/faces.hpp"
#include "minimum_weight/interval_program.hpp"
#include "minimum_weight/length_bounds.hpp"
#include "minimum_weight/lmt_skeleton.hpp"
#include "minimum_weight/triangle_support.hpp"

namespace crofton::triangulate {

class MinimumWeight {
  public:
    // False if a budget ran out before all faces had a triangulation; then known_edges() has the edges found so far.
    // Errors: cancelled.
    [[nodiscard]] Result<bool> solve(const Domain& domain, const TriangulateOptions& options, Watch& watch,
                                     Triangulation& result);
    // Diagonals that are proven to be in a minimum-weight triangulation, or in the best one known of a face.
    [[nodiscard]] std::span<const Segment> known_edges() const { return diagonals_; }
    // The proven bound on how much heavier than the minimum a triangulation of the last domain with this weight is.
    [[nodiscard]] double gap_of(double weight) const {
        return lower_bound_ > 0.0 ? weight / lower_bound_ - 1.0 : std::numeric_limits<double>::infinity();
    }

  private:
    [[nodiscard]] bool collect_convex_ring(const Domain& domain, std::size_t bytes);
    void finish_convex(const Domain& domain, Triangulation& result);
    [[nodiscard]] bool divide_into_faces(const Domain& domain, const TriangulateOptions& options, Watch& watch);
    [[nodiscard]] bool has_pieces() const;
    void mark_simple_faces();
    [[nodiscard]] FaceSearch::Outcome solve_face(std::span<const glm::dvec2> points, Index name, Watch& watch,
                                                 double fraction);
    void bound_whole(const Domain& domain, bool candidates);
    void bound_unsolved(std::span<const glm::dvec2> points);
    void bound_by_arcs(const Domain& domain, bool candidates);
    void finish(const Domain& domain, bool complete, Triangulation& result);

    CandidateGraph graph_;
    CandidateFinder finder_;
    LmtSkeleton skeleton_;
    TriangleSupport support_;
    TriangleSupport::Lists lists_;
    Faces faces_;
    IntervalProgram program_;
    FaceSearch search_;
    Vector<std::array<Index, 3>> corners_;
    Vector<Segment> diagonals_;
    Vector<Index> ring_;
    Vector<Index> unsolved_;  // names of faces
    DelaunayBound delaunay_bound_;
    ArcBound arc_bound_;
    Vector<double> lengths_;
    double lower_bound_ = 0.0;
    bool proven_ = true, infeasible_ = false, gave_up_ = false;
};

}  // namespace crofton::triangulate
