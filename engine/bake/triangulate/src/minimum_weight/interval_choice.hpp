// SPDX-License-Identifier: MIT
// The exact minimum among the triangulations that an interval programme in double cannot distinguish.
#pragma once
#include <array>
#include <crofton/core/memory.hpp>
#include <span>

#include "domain/half_edge_mesh.hpp"
#include "numbers/double_double.hpp"
#include "numbers/pair_table.hpp"
#include "numbers/root_sums.hpp"
#include "watch.hpp"

namespace crofton::triangulate {

// A face, for the interval programme. Corner i's slots are [first[i], first[i + 1]): its outgoing side, the candidates
// inside, its incoming side, counter-clockwise. Their targets ascend cyclically from i + 1 to i − 1.
struct IntervalTable {
    std::span<const glm::dvec2> points;
    Vector<Index> vertices;  // corner → vertex
    Vector<Index> first;
    Vector<Index> target;  // slot → corner
    Vector<Index> twin;    // slot → the same edge's slot at its target
    Vector<double> value;  // slot → this edge and all inside the polygon that it cuts off from the root, rounded
    // Computed values and the true least weights differ by at most half of this, relative to either.
    double error_bound = 0.0;

    [[nodiscard]] Index corner_count() const { return static_cast<Index>(vertices.size()); }
};

// Goes down from the root through all alternatives whose values lie within the error bound of the least. Only these can
// be in a minimum. Then goes up again and keeps of each interval the least alternative, exactly; of equal ones the one
// whose apex comes first.
//
// Values to 100 bits distinguish nearly all alternatives. Symmetric faces have many that are truly equal, so intervals
// proven to be of equal weight share a class: two alternatives made of the same classes tie. RootSums decides the rest,
// and what it finds equal joins the classes.
class IntervalChoice {
  public:
    // Returns false if the watch stops.
    [[nodiscard]] bool run(const IntervalTable& table, Watch& watch, double fraction);

    // Calls visit(low, middle, high) for the triangles of the minimum found, corners of the face, outer ones first.
    template <class Visit>
    void for_each_triangle(Visit visit) const {
        stack_.assign(1, 0);
        while (!stack_.empty()) {
            const Node& node = nodes_[stack_.back()];
            stack_.pop_back();
            visit(node.low, node.middle, node.high);
            for (const Index child : {node.left, node.right})
                if (child != kNone) stack_.push_back(child);
        }
    }

  private:
    // An interval of corners and the edge that closes it. `left` and `right` are the nodes of its sub-intervals, kNone
    // for sides.
    struct Node {
        Index low, high, slot;
        Index begin, end;  // of its alternatives
        Index middle, left, right;
        Index weight_class;
        DoubleDouble value;
    };
    struct Alternative {
        Index middle, left, right;  // left and right are slots until their nodes are known
        double value;
    };

    [[nodiscard]] std::size_t expand(Index node);
    [[nodiscard]] Index node_of(Index low, Index high, Index slot);
    void sort_by_width();
    void decide(std::size_t place);
    [[nodiscard]] DoubleDouble value_of(const Alternative& a) const;
    [[nodiscard]] bool lighter(std::size_t place, const Alternative& a, const Alternative& b);
    void classify(Node& node);
    [[nodiscard]] Index pair_class(Index left, Index right);
    [[nodiscard]] Index length_class(const glm::dvec2& a, const glm::dvec2& b);
    void collect_edges(const Alternative& alternative, Vector<Segment>& edges) const;

    const IntervalTable* table_ = nullptr;
    Vector<Node> nodes_;
    Vector<Alternative> alternatives_;
    Vector<Index> node_of_slot_, order_, width_begin_;
    // Classes, once two alternatives need them.
    bool has_classes_ = false;
    PairTable pairs_, weights_, lengths_, extents_;
    Vector<Index> equal_pairs_;  // a forest: pairs of classes that are proven to weigh the same
    RootSums sums_;
    Vector<Segment> left_edges_, right_edges_;
    mutable Vector<Index> stack_;
};

}  // namespace crofton::triangulate
