// SPDX-License-Identifier: MIT
#include "minimum_weight/triangle_support.hpp"

#include <algorithm>
#include <crofton/geometry/predicates.hpp>

#include "minimum_weight/local_minimality.hpp"

namespace crofton::triangulate {
namespace {
// The shares of the work that are done when listing and pruning begin, as reported to the caller.
constexpr double kListing = 0.5, kPruning = 0.55;
}  // namespace

void TriangleSupport::start(std::span<const glm::dvec2> points, CandidateGraph& graph, Lists& lists) {
    points_ = points;
    graph_ = &graph;
    lists_ = &lists;
    feasible_ = true;
    stack_.clear();
    queued_.assign(graph.half_edge_count(), 0);
}

bool TriangleSupport::build(std::span<const glm::dvec2> points, CandidateGraph& graph, std::size_t limit, Watch& watch,
                            Lists& lists) {
    start(points, graph, lists);
    if (!list_triangles(limit, watch)) return true;
    drop_incomplete(watch);
    return run(watch);
}

bool TriangleSupport::update(std::span<const Index> dead, std::span<const glm::dvec2> points, CandidateGraph& graph,
                             Watch& watch, Lists& lists) {
    start(points, graph, lists);
    for (const Index h : dead) kill(h);
    return run(watch);
}

// Edges are visited at their lower vertex, and both sides of an edge at once, so that each list is contiguous.
bool TriangleSupport::list_triangles(std::size_t limit, Watch& watch) {
    const auto& g = *graph_;
    lists_->entries.clear();
    lists_->ranges.assign(g.half_edge_count(), {0, 0});
    leaving_.assign(g.vertex_count(), kNone);
    admitted_.assign(g.vertex_count(), kNone);
    for (Index p = 0; p < g.vertex_count(); ++p) {
        if (lists_->entries.size() > limit) return false;
        for (Index h = g.first[p]; h < g.first[p + 1]; ++h) leaving_[g.destination[h]] = alive(h) ? h : kNone;
        for (Index h = g.first[p]; h < g.first[p + 1]; ++h) {
            if (g.destination[h] < p || !alive(h) || (!left_inside(h) && !left_inside(g.twin[h]))) continue;
            const Index q = g.destination[h];
            if (watch.stopped(kListing, g.first[p + 1] - g.first[p] + g.first[q + 1] - g.first[q])) return false;
            collect_sides(h);
            if (watch.stopped(kListing, left_.size() * right_.size())) return false;
            if (!fixed(h)) support_sides(h);
            store(h, left_);
            store(g.twin[h], right_);
            if (!fixed(h) && left_.empty()) kill(h);
            if (!alive(h)) leaving_[g.destination[h]] = kNone;
        }
        for (Index h = g.first[p]; h < g.first[p + 1]; ++h) leaving_[g.destination[h]] = kNone;
    }
    return true;
}

// The triangles left and right of h, whose origin is the vertex in turn.
void TriangleSupport::collect_sides(Index h) {
    const auto& g = *graph_;
    const Index twin = g.twin[h];
    left_.clear();
    right_.clear();
    // Marks what the lower end admits with the half-edge on whose left it lies.
    if (left_inside(h)) scan<+1>(h, [&](Index k) { admitted_[g.destination[k]] = h; });
    if (left_inside(twin)) scan<-1>(h, [&](Index k) { admitted_[g.destination[k]] = twin; });
    const auto joined = [&](Index k, Index side) {
        const Index s = g.destination[k];
        return admitted_[s] == side && leaving_[s] != kNone && alive(k);
    };
    if (left_inside(h)) {
        scan<-1>(twin, [&](Index k) {
            const Index s = g.destination[k];
            if (joined(k, h) && left_inside(k) && left_inside(g.twin[leaving_[s]])) left_.push_back({k, s, kNone});
        });
    }
    if (left_inside(twin)) {
        scan<+1>(twin, [&](Index k) {
            const Index s = g.destination[k];
            if (joined(k, twin) && left_inside(leaving_[s]) && left_inside(g.twin[k]))
                right_.push_back({leaving_[s], s, kNone});
        });
    }
}

// Calls admit(k) for every candidate k at the origin of h that spans an empty triangle with h: on its left for
// kTurn = +1, on its right for −1. Dead candidates count too. Candidates are visited by angle from h, up to a half-turn
// or the inside's end. A triangle holds none of the ends visited before if its end is, as seen from the end of h,
// closer in direction to h than all of those.
template <int kTurn, class Admit>
void TriangleSupport::scan(Index h, Admit admit) const {
    const auto& g = *graph_;
    const Index p = origin(h), q = g.destination[h], begin = g.first[p], end = g.first[p + 1];
    const auto &at = points_[p], &to = points_[q];
    Index closest = kNone;
    for (Index k = h;;) {
        // The part between two neighbours is on the left of the right one; a dead one may end in another face.
        if (kTurn > 0 && !left_inside(k)) return;
        k = kTurn > 0 ? (k + 1 == end ? begin : k + 1) : (k == begin ? end : k) - 1;
        if (kTurn < 0 && !left_inside(k)) return;
        const Index s = g.destination[k];
        if (k == h || kTurn * orientation(at, to, points_[s]) <= 0) return;
        if (closest == kNone || kTurn * orientation(to, points_[s], points_[closest]) <= 0) {
            closest = s;
            admit(k);
        }
    }
}

// Drops the triangles on either side of h that none on the other side supports.
void TriangleSupport::support_sides(Index h) {
    const Index p = origin(h), q = graph_->destination[h];
    for (Side& l : left_) {
        for (Side& r : right_) {
            if (!locally_minimal(points_, p, q, l.vertex, r.vertex)) continue;
            l.support = r.next;
            if (r.support == kNone) r.support = l.next;
            break;
        }
    }
    for (Side& r : right_) {
        for (const Side& l : left_) {
            if (r.support != kNone) break;
            if (l.support != kNone && locally_minimal(points_, p, q, l.vertex, r.vertex)) r.support = l.next;
        }
    }
    const auto unsupported = [](const Side& s) { return s.support == kNone; };
    left_.erase(std::remove_if(left_.begin(), left_.end(), unsupported), left_.end());
    right_.erase(std::remove_if(right_.begin(), right_.end(), unsupported), right_.end());
}

void TriangleSupport::store(Index h, const Vector<Side>& side) {
    lists_->ranges[h] = {static_cast<Index>(lists_->entries.size()), static_cast<Index>(side.size())};
    for (const Side& s : side) lists_->entries.push_back({s.next, s.support});
    if (side.empty() && fixed(h) && left_inside(h)) feasible_ = false;
}

// A triangle must be in the lists of all its sides.
void TriangleSupport::drop_incomplete(Watch& watch) {
    const auto& g = *graph_;
    for (Index h = 0; h < g.half_edge_count(); ++h) {
        const Index p = origin(h);
        if (watch.stopped(kListing, 4 * lists_->ranges[h].size)) return;
        for (Index i = 0; i < lists_->ranges[h].size;) {
            const Index next = entries(h)[i].next;
            const auto others = entries(next);
            const auto same = [&](const Lists::Entry& e) { return g.destination[e.next] == p; };
            if (std::any_of(others.begin(), others.end(), same))
                ++i;
            else
                remove_triangle(h, next);
        }
    }
}

bool TriangleSupport::run(Watch& watch) {
    while (!stack_.empty() && feasible_) {
        const Index h = stack_.back();
        stack_.pop_back();
        queued_[h] = 0;
        if (watch.stopped(kPruning, 4 * lists_->ranges[h].size + 1)) return true;
        if (alive(h)) check(h);
    }
    return feasible_;
}

// Something beyond h died: triangles that it supported need another support.
void TriangleSupport::check(Index h) {
    for (Index i = 0; i < lists_->ranges[h].size;) {
        Lists::Entry& entry = entries(h)[i];
        if (find_support(h, entry))
            ++i;
        else
            remove_triangle(h, entry.next);
    }
    if (lists_->ranges[h].size == 0) kill(h);
}

bool TriangleSupport::find_support(Index h, Lists::Entry& entry) const {
    const auto& g = *graph_;
    const auto beyond = entries(g.twin[h]);
    for (const auto& e : beyond) {
        if (e.next == entry.support) return true;
    }
    const Index p = origin(h), q = g.destination[h];
    for (const auto& e : beyond) {
        if (!locally_minimal(points_, p, q, g.destination[entry.next], g.destination[e.next])) continue;
        entry.support = e.next;
        return true;
    }
    return false;
}

void TriangleSupport::remove_triangle(Index h, Index next) {
    const Index last = edge_between(graph_->destination[next], origin(h));
    remove_entry(h, next);
    remove_entry(next, last);
    remove_entry(last, h);
}

// Does nothing if the triangle is not in this list.
void TriangleSupport::remove_entry(Index h, Index next) {
    const auto list = entries(h);
    for (auto& e : list) {
        if (e.next != next) continue;
        e = list.back();
        --lists_->ranges[h].size;
        const Index twin = graph_->twin[h];
        if (fixed(h)) {
            if (lists_->ranges[h].size == 0) feasible_ = false;
        } else if (!queued_[twin]) {
            queued_[twin] = 1;
            stack_.push_back(twin);
        }
        return;
    }
}

// The edge dies, and all triangles that have it.
void TriangleSupport::kill(Index h) {
    for (const Index k : {h, graph_->twin[h]}) {
        graph_->flags[k] |= CandidateGraph::kDead;
        while (lists_->ranges[k].size > 0) remove_triangle(k, entries(k).back().next);
    }
}

Index TriangleSupport::edge_between(Index from, Index to) const {
    Index h = graph_->first[from];
    while (graph_->destination[h] != to) ++h;
    return h;
}

}  // namespace crofton::triangulate
