// Ear clipping: quick to understand, and what most engines do today.
#pragma once
#include <array>

#include "domain.hpp"
#include "reflex_grid.hpp"

namespace crofton::triangulate {

// Joins the pieces of the boundary by the shortest Delaunay edges that do so and cuts ears off the walks that result.
class EarClipping {
  public:
    // Appends triangles as half-edges of the domain's mesh whose origins are the corners; returns the diagonals'
    // length.
    [[nodiscard]] double run(const Domain& domain, Vector<std::array<Index, 3>>& triangles);

  private:
    struct Corner {
        Index half_edge;  // leaves the corner
        Index vertex;
        Index previous, next;
        bool reflex;
    };

    void join_pieces();
    [[nodiscard]] Index find(Index vertex);
    void collect_walk(Index start);
    void clip(Vector<std::array<Index, 3>>& triangles);
    [[nodiscard]] bool is_reflex(const Corner& corner) const;
    [[nodiscard]] bool is_ear(const Corner& corner) const;
    [[nodiscard]] bool opens_towards(const Corner& corner, Index vertex) const;
    void update(Corner& corner);

    const Domain* domain_ = nullptr;
    const HalfEdgeMesh* mesh_ = nullptr;
    Vector<std::uint8_t> wall_, walked_;
    Vector<Index> parent_, bridges_, reflex_count_, reflex_;
    ReflexGrid grid_;
    Vector<Corner> corners_;
    double weight_ = 0.0;
};

}  // namespace crofton::triangulate
