#include "interval_program.hpp"

#include <cmath>
#include <limits>

namespace crofton::triangulate {
namespace {
constexpr double kInfinity = std::numeric_limits<double>::infinity();
}

void IntervalProgram::start(std::span<const glm::dvec2> points, const CandidateGraph& graph) {
    points_ = points;
    graph_ = &graph;
    slot_of_.resize(graph.half_edge_count());
}

// Corner i's slots are its out-going side, the candidate edges inside, and its in-coming side, counter-clockwise: their
// targets ascend cyclically from i + 1 to i − 1.
void IntervalProgram::collect_slots(std::span<const Index> walk) {
    const auto& g = *graph_;
    const auto count = static_cast<Index>(walk.size());
    walk_ = walk;
    slots_.clear();
    slot_edge_.clear();
    first_.resize(count + 1);
    vertices_.resize(count);
    Index origin = g.destination[walk[count - 1]];
    for (Index i = 0; i < count; ++i) {
        vertices_[i] = origin;
        first_[i] = static_cast<Index>(slots_.size());
        const Index begin = g.first[origin], end = g.first[origin + 1];
        const Index incoming = g.twin[walk[i == 0 ? count - 1 : i - 1]];
        slots_.push_back({i + 1 == count ? 0 : i + 1, 0, 0, 0.0, 0.0});
        slot_edge_.push_back(walk[i]);
        for (Index h = walk[i] + 1 == end ? begin : walk[i] + 1; h != incoming; h = h + 1 == end ? begin : h + 1) {
            if ((g.flags[h] & CandidateGraph::kDead) != 0) continue;
            slot_of_[h] = static_cast<Index>(slots_.size());
            slots_.push_back({i, 0, 0, 0.0, kInfinity});  // target is set through the twin
            slot_edge_.push_back(h);
        }
        slots_.push_back({i == 0 ? count - 1 : i - 1, 0, 0, 0.0, 0.0});
        slot_edge_.push_back(incoming);
        origin = g.destination[walk[i]];
    }
    first_[count] = static_cast<Index>(slots_.size());
    for (Index i = 0; i < count; ++i) {
        const Index out = first_[i], in = first_[i + 1 == count ? 1 : i + 2] - 1;
        slots_[out].twin = in;
        slots_[in].twin = out;
        for (Index s = first_[i] + 1; s + 1 < first_[i + 1]; ++s) {
            const Index t = slot_of_[g.twin[slot_edge_[s]]];
            slots_[s].twin = t;
            if (t < s) continue;
            const glm::dvec2 d = points_[vertices_[i]] - points_[g.destination[slot_edge_[s]]];
            slots_[s].length = slots_[t].length = std::sqrt(d.x * d.x + d.y * d.y);
        }
    }
    // Each slot still names its own corner: give it its twin's.
    for (Index i = 0; i < count; ++i) {
        for (Index s = first_[i] + 1; s + 1 < first_[i + 1]; ++s) {
            if (slots_[s].twin > s) std::swap(slots_[s].target, slots_[slots_[s].twin].target);
        }
    }
}

double IntervalProgram::solve(std::span<const Index> walk, Watch& watch, double fraction) {
    collect_slots(walk);
    const auto count = static_cast<Index>(walk.size());
    // A length has a relative error below 4u (two differences, squares, sum, root; u = 2^-53), a sum of m such terms in
    // any order below (m + 4)u; two of them and the rounding of this product: 2(m + 8)u.
    tolerance_ = (count + 8.0) * 0x1p-52;
    for (Index low = count - 1; low-- > 0;) {
        const bool root = low == 0;
        if (watch.stopped(fraction, 1)) return kInfinity;
        for (Index s = first_[low] + 1; s + 1 < first_[low + 1]; ++s) {
            Slot& slot = slots_[s];
            if (slot.target < low) break;  // targets ascend from low + 1 and then wrap
            if (watch.stopped(fraction, s - first_[low] + first_[slot.target + 1] - slot.twin)) return kInfinity;
            const Best best = combine(low, slot.target, s, slot.twin + 1);
            slot.middle = slots_[slot.twin].middle = best.middle;
            slot.value = slots_[slot.twin].value = best.value + slot.length;
        }
        if (root) {
            const Best best = combine(0, count - 1, first_[1] - 1, first_[count - 1] + 1);
            root_middle_ = best.middle;
            return best.value;
        }
    }
    return kInfinity;
}

// The best apex over the edge from low to high: a corner that is a target of both. Slots [first of low, low_end) hold
// low's targets below high, [high_begin, end of high) high's targets above low; both ascend.
IntervalProgram::Best IntervalProgram::combine(Index low, Index high, Index low_end, Index high_begin) {
    Best best{kInfinity, kNone};
    Index a = first_[low], b = high_begin;
    const Index b_end = first_[high + 1];
    while (a < low_end && b < b_end) {
        const Index at = slots_[a].target, bt = slots_[b].target;
        if (at == bt) {
            ++steps_;
            const double value = slots_[a].value + slots_[b].value;
            if (value < best.value) {
                const bool clear = value < best.value - best.value * tolerance_ || best.middle == kNone;
                if (clear || lighter(low, high, at, best.middle)) best = {value, at};
            } else if (value <= best.value + best.value * tolerance_ && value < kInfinity) {
                if (lighter(low, high, at, best.middle)) best = {value, at};
            }
        }
        a += at <= bt;
        b += bt <= at;
    }
    return best;
}

bool IntervalProgram::lighter(Index low, Index high, Index middle, Index than) const {
    left_edges_.clear();
    right_edges_.clear();
    collect_edges(low, high, middle, left_edges_);
    collect_edges(low, high, than, right_edges_);
    return sums_.compare(points_, left_edges_, right_edges_) < 0;
}

Index IntervalProgram::slot_between(Index low, Index high) const {
    for (Index s = first_[low];; ++s) {
        if (slots_[s].target == high) return s;
    }
}

void IntervalProgram::collect_edges(Index low, Index high, Index middle, Vector<Segment>& edges) const {
    stack_.assign(1, {low, high, middle});
    while (!stack_.empty()) {
        const Interval at = stack_.back();
        stack_.pop_back();
        for (const auto& [from, to] : {std::array{at.low, at.middle}, std::array{at.middle, at.high}}) {
            if (to == from + 1) continue;
            edges.push_back({vertices_[from], vertices_[to]});
            stack_.push_back({from, to, slots_[slot_between(from, to)].middle});
        }
    }
}

void IntervalProgram::append(Vector<std::array<Index, 3>>& triangles, Vector<Segment>& diagonals) const {
    const auto last = static_cast<Index>(walk_.size() - 1);
    stack_.assign(1, {0, last, root_middle_});
    while (!stack_.empty()) {
        const Interval at = stack_.back();
        stack_.pop_back();
        triangles.push_back({walk_[at.low], walk_[at.middle], walk_[at.high]});
        for (const auto& [from, to] : {std::array{at.low, at.middle}, std::array{at.middle, at.high}}) {
            if (to == from + 1) continue;
            diagonals.push_back({vertices_[from], vertices_[to]});
            stack_.push_back({from, to, slots_[slot_between(from, to)].middle});
        }
    }
}

}  // namespace crofton::triangulate
