// SPDX-License-Identifier: MIT
// A triangulation made lighter piece by piece: what is done where the minimum is out of reach.
#pragma once
#include <array>

#include "domain/domain.hpp"
#include "numbers/pair_table.hpp"
#include "watch.hpp"

namespace crofton::triangulate {

// Takes a triangulation of a domain's inside and flips diagonals while one becomes shorter. Then it replaces windows of
// some fifty triangles by their exact minima while one becomes lighter. Never makes it heavier. Linear for a given
// window.
class LocalImprovement {
  public:
    // The triangulation that the domain's mesh holds.
    void start_from_mesh(const Domain& domain);
    // One of the caller's indices; false if it is not in this domain.
    [[nodiscard]] bool start_from_triangles(const Domain& domain,
                                            std::span<const std::array<std::uint32_t, 3>> triangles);
    // Ends early where the watch is cancelled; the triangulation is one all the same.
    void run(Watch& watch);
    // The total length of the diagonals, in the units of the domain's mesh.
    [[nodiscard]] double weight() const;
    void write(Vector<std::array<std::uint32_t, 3>>& triangles) const;

  private:
    // A side of the window: the half-edge beyond it and the corner that it leaves.
    struct Side {
        Index beyond;
        std::uint8_t fixed;
        Index vertex, input;
    };
    // An interval of the window's corners still to be filled, and the half-edge beyond its edge.
    struct Open {
        Index low, high, beyond;
    };

    [[nodiscard]] Index triangle_count() const { return static_cast<Index>(origin_.size() / 4); }
    [[nodiscard]] Index destination(Index e) const { return origin_[next(e)]; }
    [[nodiscard]] Index apex(Index e) const { return origin_[previous(e)]; }
    [[nodiscard]] bool is_diagonal(Index e) const { return twin_[e] != kNone && fixed_[e] == 0; }
    void clear(const Domain& domain, Index triangles);
    void link(Index e, Index f);
    void flip_all(Watch& watch);
    void flip(Index e);
    void improve_windows(Watch& watch);
    [[nodiscard]] bool improve_window(Index seed);
    void collect_window(Index seed);
    void collect_boundary();
    [[nodiscard]] double solve_window();
    void replace_window();

    std::span<const glm::dvec2> points_;
    const Domain* domain_ = nullptr;
    // Half-edges as in HalfEdgeMesh, of the inside only; `input_` is the caller's index of the corner at origin_.
    Vector<Index> origin_, twin_, input_;
    Vector<std::uint8_t> fixed_;
    PairTable pairs_;
    Vector<Index> stack_, half_edge_of_;
    Vector<std::uint8_t> waiting_, done_;
    Vector<Index> triangle_map_;

    // The window: its triangles, and its sides counter-clockwise.
    Vector<Index> window_, vertex_stamp_, triangle_stamp_;
    Index stamp_ = 0;
    Vector<Side> sides_;
    Vector<glm::dvec2> corners_;
    Vector<double> values_;       // [low * count + high]
    Vector<std::uint16_t> apex_;  // likewise
    Vector<Open> open_;
    double window_weight_ = 0.0;
};

}  // namespace crofton::triangulate
