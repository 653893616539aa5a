// Exact minimum-weight triangulation of a domain: candidates, LMT skeleton, interval programmes, branching.
#pragma once
#include <crofton/triangulate/triangulate.hpp>

#include "face_search.hpp"
#include "faces.hpp"
#include "interval_program.hpp"
#include "lmt_skeleton.hpp"

namespace crofton::triangulate {

class MinimumWeight {
  public:
    // Fills everything but `triangles` beyond what it finds; false if a budget ran out before any triangulation was
    // found.
    [[nodiscard]] Result<bool> solve(const Domain& domain, const Options& options, Triangulation& result);

  private:
    void write(const Domain& domain, Triangulation& result);

    CandidateGraph graph_;
    CandidateFinder finder_;
    LmtSkeleton skeleton_;
    LmtSkeleton::Certificates certificates_;
    Faces faces_;
    IntervalProgram program_;
    FaceSearch search_;
    Vector<std::array<Index, 3>> corners_;
    Vector<Segment> diagonals_;
};

}  // namespace crofton::triangulate
