// SPDX-License-Identifier: MIT
// How short the diagonals of any triangulation can be: what is known when there was no time for more.
#pragma once
#include <span>

#include "domain/domain.hpp"

namespace crofton::triangulate {

// A lower bound on the total length of the diagonals of any triangulation of a domain, from its constrained Delaunay
// triangulation alone, in the units of its mesh. Rounding is left to the caller. O(n log n).
class DelaunayBound {
  public:
    [[nodiscard]] double weight(const Domain& domain);
    // By vertex of the last domain: no diagonal from it is shorter. Infinite where there is none.
    [[nodiscard]] std::span<const double> shortest() const { return shortest_; }

  private:
    struct Side {
        Index from, to;
    };
    void measure(const Domain& domain);
    [[nodiscard]] double shortest_diagonal(const Domain& domain, Index v);
    void rank();

    Vector<double> shortest_;
    Vector<Side> sides_;  // constrained edges of the inside
    Vector<Index> order_, rank_, closed_, open_;
    double slits_ = 0.0;
    std::size_t diagonals_ = 0;
};

}  // namespace crofton::triangulate
