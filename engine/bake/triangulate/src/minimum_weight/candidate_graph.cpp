// SPDX-License-Identifier: MIT
#include "minimum_weight/candidate_graph.hpp"

#include <algorithm>
#include <crofton/geometry/predicates.hpp>
#include <limits>

namespace crofton::triangulate {
namespace {

// Diamond test (Drysdale, McElfresh, Snoeyink, "On exclusion regions for optimal triangulations", 2001): an edge is in
// no minimum-weight triangulation if both isosceles triangles on it with base angle π/4.6 hold a vertex. tan(π/4.6) =
// 0.81346…; the last digits are cut off, which outweighs the rounding of the expressions below (relative 2^-50) and can
// only keep more edges.
constexpr double kTangent = 0.8134;
constexpr double kCotangent = 1.0 / kTangent;
constexpr double kRoundingUp = 1.0 + 1e-12;
// How many neighbours in angular order are tried as witnesses on each side: pruning less is never wrong.
constexpr std::size_t kNeighbours = 16;
constexpr std::size_t kStepsPerEdge = 8;
constexpr double kFound = 0.5;  // the share of the work that is done with them, as told to the caller

double cross(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}
double dot(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.x + a.y * b.y;
}

// A vertex y seen from the end 0 of the segment to q, `turn` = cross(q, y) signed so that y's side is positive.
enum class Witness : std::uint8_t { none, kills, beyond };

// Whether y lies in the isosceles triangle over the segment; `beyond` if its angle is too large, and so is every later
// one's.
Witness test_witness(const glm::dvec2& q, double q_square, const glm::dvec2& y, double turn) {
    const double along = dot(q, y);
    if (turn > kTangent * along) return Witness::beyond;
    return turn > 0.0 && turn <= kTangent * (q_square - along) ? Witness::kills : Witness::none;
}

void reserve(CandidateGraph& graph, std::size_t half_edges) {
    graph.destination.reserve(half_edges);
    graph.flags.reserve(half_edges);
}

}  // namespace

bool CandidateFinder::find(const Domain& domain, std::size_t limit, Watch& watch, CandidateGraph& graph) {
    domain_ = &domain;
    mesh_ = &domain.mesh();
    const auto count = static_cast<Index>(mesh_->points.size());
    graph.first.assign(1, 0);
    graph.destination.clear();
    graph.flags.clear();
    graph.input.clear();
    const bool shared = domain.has_shared_positions();
    for (Index p = 0; p < count; ++p) {
        seen_.clear();
        look_from(p);
        if (graph.destination.size() + seen_.size() > limit) return false;
        if (watch.stopped(kFound * p / count, kStepsPerEdge * (seen_.size() + 1))) return false;
        if (p == count / 16) reserve(graph, 18 * graph.destination.size());
        for (const auto& seen : seen_) {
            graph.destination.push_back(seen.vertex);
            graph.flags.push_back(seen.flags);
            if (shared) graph.input.push_back(seen.input);
        }
        graph.first.push_back(static_cast<Index>(graph.destination.size()));
    }
    return match_twins(graph, watch);
}

void CandidateFinder::look_from(Index p) {
    from_ = p;
    eye_ = mesh_->points[p];
    const Index start = mesh_->vertex_edge[p];
    const bool shared = domain_->has_shared_positions();
    const auto flags_of = [&](Index e) {
        return static_cast<std::uint8_t>(CandidateGraph::kDelaunay |
                                         (mesh_->mark[e] != 0 ? CandidateGraph::kConstraint : 0));
    };
    const Index before = mesh_->twin[start];
    bool previous_inside = before != kNone && domain_->inside(before / 4);
    std::size_t run = 0;
    for (Index e = start; e != kNone;) {
        const bool here = domain_->inside(e / 4);
        const Index back = previous(e), after = mesh_->twin[back];
        if (here) {
            const Index input = shared ? domain_->input_index(e) : 0;
            if (!previous_inside) {
                run = seen_.size();
                seen_.push_back({mesh_->destination(e), flags_of(e), input});
            }
            const std::size_t begin = seen_.size();
            look_through(next(e), mesh_->destination(e), mesh_->origin[back]);
            for (std::size_t i = begin; i < seen_.size(); ++i) seen_[i].input = input;
            std::uint8_t flags = flags_of(back);
            const bool inside_after = after != kNone && domain_->inside(after / 4);
            if (!inside_after) flags |= CandidateGraph::kLeftOutside;
            // The corner beyond belongs to the next sector if a slit or boundary starts it.
            const Index beyond = shared && inside_after ? domain_->input_index(after) : input;
            seen_.push_back({mesh_->origin[back], flags, beyond});
            if (!inside_after) filter(run, seen_.size());
        }
        previous_inside = here;
        e = after;
        if (e == start) {
            if (previous_inside) filter(run, seen_.size());
            break;
        }
    }
}

// Visible vertices strictly between right and left beyond the edge, counter-clockwise: the stack gets the left part
// first.
void CandidateFinder::look_through(Index edge, Index right, Index left) {
    const auto& points = mesh_->points;
    views_.assign(1, {edge, right, left, right, left});
    while (!views_.empty()) {
        View view = views_.back();
        views_.pop_back();
        if (view.edge == kNone) {
            seen_.push_back({view.right, 0, 0});
            continue;
        }
        if (mesh_->mark[view.edge] != 0 || is_dark(view)) continue;
        const Index e = mesh_->twin[view.edge];  // from the left end of the edge to the right one
        const Index apex = mesh_->apex(e);
        View to_left = view, to_right = view;
        to_left.edge = previous(e);
        to_right.edge = next(e);
        if (orientation(eye_, points[view.right], points[apex]) <= 0) {
            views_.push_back(to_left);
        } else if (orientation(eye_, points[apex], points[view.left]) <= 0) {
            views_.push_back(to_right);
        } else {
            to_left.right = to_right.left = apex;
            views_.push_back(to_left);
            views_.push_back({kNone, apex, apex, apex, apex});
            views_.push_back(to_right);
        }
    }
}

// Whether the diamond test kills everything in the view. A visible y at angle θ ≤ α right of the direction of q lies in
// q's triangle if |q| ≥ |y| sin(θ + α) / sin α = |y| (cos θ + sin θ cot α), which grows with θ up to α; so with θ taken
// to the left end of the view the bound holds for the whole view. Everything in it is at least as far as the line of
// its edge.
bool CandidateFinder::is_dark(View& view) const {
    const auto& points = mesh_->points;
    const glm::dvec2 right = points[view.right] - eye_, left = points[view.left] - eye_;
    // How far each end lets see, times the length of the other, while the view is at most α wide; else no witness
    // reaches across.
    const double along = dot(right, left), across = cross(right, left);
    if (across > kTangent * along) return false;
    double right_limit = along + across * kCotangent, left_limit = right_limit;
    const auto inherit = [&](Index& witness, Index end, const glm::dvec2& far, double side, double& limit) {
        if (witness == end) return;
        const glm::dvec2 y = points[witness] - eye_;
        const double y_along = dot(y, far), y_across = side * cross(y, far);
        const double y_limit = y_along + y_across * kCotangent;
        if (y_across <= kTangent * y_along && y_limit < limit)
            limit = y_limit;
        else
            witness = end;
    };
    inherit(view.right_witness, view.right, left, 1.0, right_limit);
    inherit(view.left_witness, view.left, right, -1.0, left_limit);
    right_limit *= kRoundingUp;
    left_limit *= kRoundingUp;
    const glm::dvec2 a = points[mesh_->origin[view.edge]] - eye_, b = points[mesh_->destination(view.edge)] - eye_;
    const double area = cross(a, b), area2 = area * area;
    const double side2 = dot(a - b, a - b);
    return area2 * dot(left, left) >= right_limit * right_limit * side2 &&
           area2 * dot(right, right) >= left_limit * left_limit * side2;
}

// Drops what the diamond test kills by witnesses among the neighbours in seen_[begin, end), one sector. Witnesses
// behind a slit from here do not count: what they see of the edge's other end the slit may hide.
void CandidateFinder::filter(std::size_t begin, std::size_t end) {
    const auto& points = mesh_->points;
    if (end - begin < 3) return;
    vectors_.resize(end - begin);
    for (std::size_t i = begin; i < end; ++i) vectors_[i - begin] = points[seen_[i].vertex] - eye_;
    std::size_t kept = begin + 1, slit = 0;
    const std::size_t count = end - begin;
    const auto is_constraint = [&](std::size_t i) {
        return (seen_[begin + i].flags & CandidateGraph::kConstraint) != 0;
    };
    for (std::size_t i = 1; i < count; ++i) {
        bool keep = i + 1 == count;
        if (is_constraint(i)) {
            keep = true;
            slit = i;
        }
        if (!keep) {
            const glm::dvec2 q = vectors_[i];
            const double q_square = dot(q, q);
            const std::size_t low = std::max(slit, i > kNeighbours ? i - kNeighbours : 0),
                              high = std::min(count, i + kNeighbours + 1);
            Witness right = Witness::none, left = Witness::none;
            for (std::size_t j = i; j-- > low && right == Witness::none;) {
                right = test_witness(q, q_square, vectors_[j], cross(vectors_[j], q));
            }
            if (right == Witness::kills) {
                for (std::size_t j = i + 1; j < high && left == Witness::none; ++j) {
                    left = test_witness(q, q_square, vectors_[j], cross(q, vectors_[j]));
                    if (is_constraint(j)) break;
                }
            }
            keep = left != Witness::kills;
        }
        if (keep) seen_[kept++] = seen_[begin + i];
    }
    seen_.resize(kept);
}

// Keeps the half-edges whose twin was found too, and joins them. Vertices are visited in order; each leaves its
// half-edges to later vertices in those vertices' lists.
bool CandidateFinder::match_twins(CandidateGraph& graph, Watch& watch) {
    const auto count = static_cast<Index>(graph.vertex_count());
    const auto half_edges = static_cast<Index>(graph.half_edge_count());
    graph.twin.assign(half_edges, kNone);
    pending_head_.assign(count, kNone);
    pending_origin_.resize(half_edges);
    renumbered_.resize(half_edges);
    Vector<Index>& pending_next = renumbered_;  // until all are matched
    stamp_.assign(count, kNone);
    for (Index p = 0; p < count; ++p) {
        // While p is visited, stamp_ leads from an earlier vertex to its half-edge to p. Entries left from other visits
        // name half-edges with another destination.
        if (watch.stopped(kFound, graph.first[p + 1] - graph.first[p])) return false;
        for (Index h = pending_head_[p]; h != kNone; h = pending_next[h]) stamp_[pending_origin_[h]] = h;
        for (Index h = graph.first[p]; h < graph.first[p + 1]; ++h) {
            const Index q = graph.destination[h];
            if (q > p) {
                pending_origin_[h] = p;
                pending_next[h] = pending_head_[q];
                pending_head_[q] = h;
            } else if (stamp_[q] != kNone && graph.destination[stamp_[q]] == p) {
                graph.twin[h] = stamp_[q];
                graph.twin[stamp_[q]] = h;
            }
        }
    }
    Index kept = 0;
    for (Index h = 0; h < half_edges; ++h) renumbered_[h] = graph.twin[h] == kNone ? kNone : kept++;
    Index h = 0, last = 0;
    for (Index p = 0; p < count; ++p) {
        for (const Index end = graph.first[p + 1]; h < end; ++h) {
            const Index to = renumbered_[h];
            if (to == kNone) continue;
            graph.destination[to] = graph.destination[h];
            graph.flags[to] = graph.flags[h];
            graph.twin[to] = renumbered_[graph.twin[h]];
            if (!graph.input.empty()) graph.input[to] = graph.input[h];
            last = to + 1;
        }
        graph.first[p + 1] = last;
    }
    graph.destination.resize(kept);
    graph.flags.resize(kept);
    graph.twin.resize(kept);
    if (!graph.input.empty()) graph.input.resize(kept);
    return true;
}

}  // namespace crofton::triangulate
