// Klincsek's interval dynamic programme, over candidate edges only.
#pragma once
#include <array>
#include <crofton/core/memory.hpp>
#include <span>

#include "candidate_graph.hpp"
#include "root_sums.hpp"
#include "watch.hpp"

namespace crofton::triangulate {

// Minimum-weight triangulations of faces: closed walks along certain half-edges with the face on their left and nothing
// but candidate edges inside. Values are sums of at most m lengths in double; where two alternatives differ by less
// than the bound on their rounding, RootSums decides exactly.
class IntervalProgram {
  public:
    void start(std::span<const glm::dvec2> points, const CandidateGraph& graph);

    // `walk` holds each corner's outgoing half-edge, in order. Returns the weight of the edges inside, or infinity if
    // the candidates triangulate no such face or the watch stops; the walk must have at least three corners and must
    // outlive append().
    [[nodiscard]] double solve(std::span<const Index> walk, Watch& watch, double fraction);
    // Appends the triangles of the last solve, as half-edges of the graph whose origins are their corners, and the
    // lengths of the edges inside.
    void append(Vector<std::array<Index, 3>>& triangles, Vector<Segment>& diagonals) const;

    // Work done so far: combinations of two sub-polygons tried.
    [[nodiscard]] std::uint64_t steps() const { return steps_; }

  private:
    struct Slot {
        Index target;  // corner
        Index twin;    // the slot of the opposite half-edge
        Index middle;  // apex of the triangle on this edge, on the side away from the root
        double length;
        double value;  // this edge and all inside the polygon that it cuts off from the root
    };
    struct Interval {
        Index low, high, middle;
    };
    struct Best {
        double value;
        Index middle;
    };

    void collect_slots(std::span<const Index> walk);
    [[nodiscard]] Best combine(Index low, Index high, Index low_end, Index high_begin);
    [[nodiscard]] bool lighter(Index low, Index high, Index middle, Index than) const;
    void collect_edges(Index low, Index high, Index middle, Vector<Segment>& edges) const;
    [[nodiscard]] Index slot_between(Index low, Index high) const;
    [[nodiscard]] Index vertex(Index corner) const { return vertices_[corner]; }

    std::span<const glm::dvec2> points_;
    const CandidateGraph* graph_ = nullptr;
    std::span<const Index> walk_;
    Vector<Slot> slots_;
    Vector<Index> first_, vertices_, slot_of_, slot_edge_;
    double tolerance_ = 0.0;
    Index root_middle_ = 0;
    std::uint64_t steps_ = 0;
    mutable RootSums sums_;
    mutable Vector<Segment> left_edges_, right_edges_;
    mutable Vector<Interval> stack_;
};

}  // namespace crofton::triangulate
