// SPDX-License-Identifier: MIT
// A lower bound on the weight of any triangulation, from short pieces of its boundary: tight if the boundary is finely
// divided.
#pragma once
#include <array>

#include "domain/domain.hpp"
#include "minimum_weight/candidate_graph.hpp"

namespace crofton::triangulate {

// The boundary is cut into arcs of some sides. Take the diagonals of a triangulation that join two vertices of an arc.
// With the arc's sides they are nested, as intervals of it: two that interleave would cross. Beyond each such interval
// there is a triangle. Its apex is on the arc, so that a longer interval follows, or it is not. Then the interval is
// bare, and both its ends have a diagonal that leaves the arc. Half of such a diagonal is the triangle's, half that of
// the one on its other side; and away from the ends of arcs no triangle is beyond intervals of two arcs. So the least
// weight of an arc's own diagonals, and of half of two leaving ones for each bare interval, is found by a dynamic
// programme, and the sum over all arcs is a lower bound.
class ArcBound {
  public:
    // In the units of the domain's mesh. Where candidates are known, diagonals are among those alive; a null pointer:
    // any two vertices may be joined. Rounding is left to the caller. Linear in the vertices, some microseconds each.
    [[nodiscard]] double weight(const Domain& domain, const CandidateGraph* candidates);

  private:
    void find_chains(const Domain& domain);
    void add_chain(Index first);
    void bound_arc(std::span<const Index> arc);
    void measure_by_candidates(std::span<const Index> arc);
    void measure_by_distance(std::span<const Index> arc);
    [[nodiscard]] bool looks_inside(Index vertex, Index other) const;
    [[nodiscard]] double distance_beyond(Index vertex) const;
    void fill_cells();
    [[nodiscard]] double least_weight(std::size_t sides);

    const CandidateGraph* candidates_ = nullptr;
    std::span<const glm::dvec2> points_;
    Vector<Index> next_, previous_, chain_, place_, stamp_;
    Vector<std::uint8_t> done_;
    Index stamp_of_arc_ = 0;
    double sum_ = 0.0;
    // For each arc: the length of the diagonal between two of its places, infinite if there is none, and of the
    // shortest one that leaves it from each.
    Vector<double> chord_, leaving_, enclosed_, bare_, reached_;
    // Points in cells, where distances are asked.
    glm::dvec2 corner_{0.0};
    double cell_ = 0.0;
    glm::ivec2 cells_{0};
    Vector<Index> first_of_cell_, next_in_cell_, in_cell_;
};

}  // namespace crofton::triangulate
