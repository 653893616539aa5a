// SPDX-License-Identifier: MIT
#include "minimum_weight/face_search.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/geometry/predicates.hpp>
#include <limits>

#include "minimum_weight/local_minimality.hpp"

namespace crofton::triangulate {
namespace {

constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();
constexpr double kSearching = 0.9;  // the share of the work that is done when searching begins, as told to the caller

double total_length(std::span<const glm::dvec2> points, std::span<const Segment> segments) {
    double sum = 0.0;
    for (const Segment& s : segments) {
        const glm::dvec2 d = points[s.from] - points[s.to];
        sum += std::sqrt(d.x * d.x + d.y * d.y);
    }
    return sum;
}

}  // namespace

FaceSearch::Outcome FaceSearch::solve(std::span<const glm::dvec2> points, const CandidateGraph& graph,
                                      const Faces& faces, Index name, Watch& watch,
                                      Vector<std::array<Index, 3>>& triangles, Vector<Segment>& diagonals) {
    if (faces.component_size[name] > kMostPieces) return Outcome::gave_up;
    levels_.resize(kMostPieces + 1);
    extract(points, graph, faces, name, levels_[0]);
    const Outcome outcome = solve_level(0, watch);
    if (outcome == Outcome::solved || outcome == Outcome::unproven) raise(levels_[0], triangles, diagonals);
    return outcome;
}

void FaceSearch::raise(const Level& level, Vector<std::array<Index, 3>>& triangles, Vector<Segment>& diagonals) const {
    for (const auto& t : level.best_triangles) {
        triangles.push_back({level.outer_half_edge[t[0]], level.outer_half_edge[t[1]], level.outer_half_edge[t[2]]});
    }
    for (const auto& d : level.best_diagonals)
        diagonals.push_back({level.outer_vertex[d.from], level.outer_vertex[d.to]});
}

// Copies one face: its walks with both half-edges of every side, and the living candidates inside.
void FaceSearch::extract(std::span<const glm::dvec2> points, const CandidateGraph& graph, const Faces& faces,
                         Index name, Level& level) {
    members_.clear();
    const auto member = [&](Index h) { return faces.walk_of[h] != kNone && faces.component[faces.walk_of[h]] == name; };
    const auto add_candidate = [&](Index h) {
        if ((graph.flags[h] & CandidateGraph::kDead) == 0) members_.push_back(h);
    };
    for (std::size_t w = 0; w < faces.walk_count(); ++w) {
        if (faces.component[w] != name) continue;
        const auto walk = faces.walk(w);
        for (std::size_t i = 0; i < walk.size(); ++i) {
            members_.push_back(walk[i]);
            members_.push_back(graph.twin[walk[i]]);
            const Index incoming = graph.twin[walk[i == 0 ? walk.size() - 1 : i - 1]];
            const Index v = graph.destination[graph.twin[walk[i]]], begin = graph.first[v], end = graph.first[v + 1];
            for (Index h = walk[i] + 1 == end ? begin : walk[i] + 1; h != incoming; h = h + 1 == end ? begin : h + 1) {
                add_candidate(h);
            }
        }
    }
    for (std::size_t i = 0; i < faces.isolated.size(); ++i) {
        if (faces.component[faces.walk_count() + i] != name) continue;
        const Index v = faces.isolated[i];
        for (Index h = graph.first[v]; h < graph.first[v + 1]; ++h) add_candidate(h);
    }
    std::sort(members_.begin(), members_.end());
    members_.erase(std::unique(members_.begin(), members_.end()), members_.end());

    CandidateGraph& g = level.graph;
    const auto count = static_cast<Index>(members_.size());
    level.outer_half_edge.assign(members_.begin(), members_.end());
    level.outer_vertex.clear();
    level.points.clear();
    g.first.clear();
    g.destination.resize(count);
    g.twin.resize(count);
    g.flags.resize(count);
    // Half-edges of one vertex are neighbours in the outer graph, and so they are here.
    for (Index h = 0; h < count; ++h) {
        const Index v = graph.destination[graph.twin[members_[h]]];
        if (level.outer_vertex.empty() || level.outer_vertex.back() != v) {
            level.outer_vertex.push_back(v);
            level.points.push_back(points[v]);
            g.first.push_back(h);
        }
    }
    g.first.push_back(count);
    const auto local = [](const Vector<Index>& sorted, Index outer) {
        return static_cast<Index>(std::lower_bound(sorted.begin(), sorted.end(), outer) - sorted.begin());
    };
    for (Index h = 0; h < count; ++h) {
        const Index outer = members_[h];
        g.twin[h] = local(level.outer_half_edge, graph.twin[outer]);
        g.destination[h] = local(level.outer_vertex, graph.destination[outer]);
        const bool fixed = (graph.flags[outer] & CandidateGraph::kFixed) != 0;
        g.flags[h] = fixed ? CandidateGraph::kConstraint : 0;
        if (fixed && !member(outer)) g.flags[h] |= CandidateGraph::kLeftOutside;
    }
}

// The smallest set of edges of which one must be in every triangulation and all of which join different pieces.
void FaceSearch::choose(Level& level) {
    const CandidateGraph& g = level.graph;
    const auto& walk_of = level.faces.walk_of;
    const std::span<const glm::dvec2> points = level.points;
    const auto open = [&](Index h) { return (g.flags[h] & (CandidateGraph::kFixed | CandidateGraph::kDead)) == 0; };
    bool found = false;
    // Candidates from v strictly left of the line through points[a] and points[b].
    const auto consider = [&](Index v, Index walk, const glm::dvec2& a, const glm::dvec2& b) {
        option_.clear();
        for (Index h = g.first[v]; h < g.first[v + 1]; ++h) {
            if (!open(h) || walk_of[h] != walk || orientation(a, b, points[g.destination[h]]) <= 0) continue;
            if (walk_of[g.twin[h]] == walk) return;
            option_.push_back(h);
        }
        if (!found || option_.size() < level.choices.size()) level.choices = option_;
        found = true;
    };
    level.choices.clear();
    for (std::size_t i = 0; i < level.faces.isolated.size(); ++i) {
        const Index v = level.faces.isolated[i], walk = static_cast<Index>(level.faces.walk_count() + i);
        for (Index h = g.first[v]; h < g.first[v + 1]; ++h) {
            if (open(h)) consider(v, walk, points[v], points[g.destination[h]]);
        }
    }
    for (std::size_t w = 0; w < level.faces.walk_count(); ++w) {
        const auto walk = level.faces.walk(w);
        for (std::size_t i = 0; i < walk.size(); ++i) {
            const Index after = g.destination[walk[i]], v = g.destination[g.twin[walk[i]]];
            const Index before = g.destination[g.twin[walk[i == 0 ? walk.size() - 1 : i - 1]]];
            if (before != after && orientation(points[before], points[v], points[after]) > 0) continue;
            consider(v, static_cast<Index>(w), points[before], points[v]);
            consider(v, static_cast<Index>(w), points[v], points[after]);
        }
    }
    std::sort(level.choices.begin(), level.choices.end(), [&](Index h, Index k) {
        const glm::dvec2 d = points[g.destination[h]] - points[g.destination[g.twin[h]]];
        const glm::dvec2 e = points[g.destination[k]] - points[g.destination[g.twin[k]]];
        const double dd = d.x * d.x + d.y * d.y, ee = e.x * e.x + e.y * e.y;
        return dd != ee ? dd < ee : h < k;
    });
}

FaceSearch::Outcome FaceSearch::solve_level(std::size_t depth, Watch& watch) {
    Level& level = levels_[depth];
    if (!support_.build(level.points, level.graph, kNoLimit, watch, level.lists)) return Outcome::infeasible;
    if (watch.stopped_now(kSearching)) return Outcome::gave_up;
    find_faces(level.graph, CandidateGraph::kFixed, level.faces);
    choose(level);
    level.witness.assign(level.graph.half_edge_count(), kNone);
    level.flags = level.graph.flags;
    bool found = false, proven = true;
    double best = 0.0;
    for (std::size_t i = 0; i < level.choices.size(); ++i) {
        level.graph.flags = level.flags;
        const Outcome outcome = solve_choice(depth, level.choices[i], watch);
        if (outcome == Outcome::gave_up) return found ? Outcome::unproven : outcome;
        if (outcome == Outcome::unproven) proven = false;
        if (outcome == Outcome::solved || outcome == Outcome::unproven) {
            const double weight = total_length(level.points, level.diagonals);
            const double tolerance = (static_cast<double>(level.diagonals.size()) + 8.0) * 0x1p-51 * weight;
            const bool lighter =
                !found || weight < best - tolerance ||
                (weight <= best + tolerance && sums_.compare(level.points, level.diagonals, level.best_diagonals) < 0);
            if (lighter) {
                best = weight;
                std::swap(level.triangles, level.best_triangles);
                std::swap(level.diagonals, level.best_diagonals);
            }
            found = true;
        }
        // The branches to come need not try what has been tried.
        const Index choice = level.choices[i];
        level.flags[choice] |= CandidateGraph::kDead;
        level.flags[level.graph.twin[choice]] |= CandidateGraph::kDead;
    }
    if (!found) return Outcome::infeasible;
    return proven ? Outcome::solved : Outcome::unproven;
}

FaceSearch::Outcome FaceSearch::solve_choice(std::size_t depth, Index choice, Watch& watch) {
    Level& level = levels_[depth];
    CandidateGraph& g = level.graph;
    const auto fix = [&](Index h) {
        g.flags[h] = static_cast<std::uint8_t>((g.flags[h] & ~CandidateGraph::kDead) | CandidateGraph::kConstraint);
    };
    const Index from = g.destination[g.twin[choice]], to = g.destination[choice];
    dead_.clear();
    for (Index h = 0; h < g.half_edge_count(); ++h) {
        const Index c = g.destination[g.twin[h]], d = g.destination[h];
        if (c < d && (g.flags[h] & (CandidateGraph::kFixed | CandidateGraph::kDead)) == 0 &&
            candidates_cross(level.points, from, to, c, d)) {
            dead_.push_back(h);
            g.flags[h] |= CandidateGraph::kDead;
            g.flags[g.twin[h]] |= CandidateGraph::kDead;
        }
    }
    fix(choice);
    fix(g.twin[choice]);
    level.working_lists = level.lists;
    if (!support_.update(dead_, level.points, g, watch, level.working_lists)) return Outcome::infeasible;
    if (!mark_certain(level, watch)) return Outcome::gave_up;
    level.triangles.clear();
    level.diagonals.clear();
    for (Index h = 0; h < g.half_edge_count(); ++h) {
        const bool fresh = (g.flags[h] & CandidateGraph::kFixed) != 0 && (level.flags[h] & CandidateGraph::kFixed) == 0;
        if (fresh && h < g.twin[h]) level.diagonals.push_back({g.destination[g.twin[h]], g.destination[h]});
    }
    return solve_rest(depth, watch);
}

bool FaceSearch::mark_certain(Level& level, Watch& watch) const {
    CandidateGraph& g = level.graph;
    if (watch.stopped_now(kSearching)) return false;
    for (Index h = 0; h < g.half_edge_count(); ++h) {
        if (h > g.twin[h] || (g.flags[h] & (CandidateGraph::kFixed | CandidateGraph::kDead)) != 0) continue;
        std::size_t steps = 1;
        const bool crossed = has_crossing(level, h, steps);
        if (watch.stopped(kSearching, steps)) return false;
        if (crossed) continue;
        g.flags[h] |= CandidateGraph::kCertain;
        g.flags[g.twin[h]] |= CandidateGraph::kCertain;
    }
    return true;
}

// An edge that leaves a living triangle's apex through h, if there is one.
Index FaceSearch::crossing_from_apex(const Level& level, Index h) const {
    const CandidateGraph& g = level.graph;
    const auto& range = level.working_lists.ranges[h];
    const Index p = g.destination[g.twin[h]];
    for (Index i = range.begin; i < range.begin + range.size; ++i) {
        const Index last = g.twin[level.working_lists.entries[i].next];
        const Index apex = g.destination[g.twin[last]], begin = g.first[apex], end = g.first[apex + 1];
        // Clockwise from the side to h's end, up to the one to its origin.
        for (Index k = (last == begin ? end : last) - 1; g.destination[k] != p; k = (k == begin ? end : k) - 1) {
            if ((g.flags[k] & CandidateGraph::kDead) == 0) return k;
        }
    }
    return kNone;
}

// Adds to `steps`.
bool FaceSearch::has_crossing(Level& level, Index h, std::size_t& steps) const {
    const CandidateGraph& g = level.graph;
    const auto open = [&](Index k) {
        return (g.flags[k] & (CandidateGraph::kConstraint | CandidateGraph::kDead)) == 0;
    };
    if (level.witness[h] != kNone && open(level.witness[h])) return true;
    if (level.witness[h] = crossing_from_apex(level, h); level.witness[h] != kNone) return true;
    const Index a = g.destination[g.twin[h]], b = g.destination[h];
    const auto [x_low, x_high] = std::minmax(level.points[a].x, level.points[b].x);
    const auto [y_low, y_high] = std::minmax(level.points[a].y, level.points[b].y);
    for (Index v = 0; v < g.vertex_count(); ++v) {
        const glm::dvec2 c = level.points[v];
        steps += 1 + (g.first[v + 1] - g.first[v]) / 4;
        for (Index k = g.first[v]; k < g.first[v + 1]; ++k) {
            if (g.destination[k] <= v || !open(k)) continue;
            const Index d = g.destination[k];
            const glm::dvec2 e = level.points[d];
            if (std::max(c.x, e.x) < x_low || std::min(c.x, e.x) > x_high) continue;
            if (std::max(c.y, e.y) < y_low || std::min(c.y, e.y) > y_high) continue;
            if (candidates_cross(level.points, a, b, v, d)) {
                level.witness[h] = k;
                return true;
            }
        }
    }
    return false;
}

FaceSearch::Outcome FaceSearch::solve_rest(std::size_t depth, Watch& watch) {
    Level& level = levels_[depth];
    find_faces(level.graph, CandidateGraph::kFixed, level.faces);
    const auto pieces = static_cast<Index>(level.faces.component.size());
    Outcome result = Outcome::solved;
    // Simple faces first: they show at once whether this branch has no triangulation.
    program_.start(level.points, level.graph);
    for (Index w = 0; w < pieces; ++w) {
        if (level.faces.component[w] != w || level.faces.component_size[w] != 1) continue;
        if (w >= level.faces.walk_count()) return Outcome::infeasible;
        const auto walk = level.faces.walk(w);
        if (walk.size() < 3 || !is_outer(level.points, level.graph, walk)) return Outcome::infeasible;
        if (!(program_.solve(walk, watch, kSearching) < std::numeric_limits<double>::infinity()))
            return watch.stopped_now(kSearching) ? Outcome::gave_up : Outcome::infeasible;
        program_.append(level.triangles, level.diagonals);
    }
    for (Index w = 0; w < pieces; ++w) {
        if (level.faces.component[w] != w || level.faces.component_size[w] == 1) continue;
        if (depth + 1 >= levels_.size()) return Outcome::gave_up;
        extract(level.points, level.graph, level.faces, w, levels_[depth + 1]);
        const Outcome outcome = solve_level(depth + 1, watch);
        if (outcome == Outcome::unproven)
            result = outcome;
        else if (outcome != Outcome::solved)
            return outcome;
        raise(levels_[depth + 1], level.triangles, level.diagonals);
    }
    return result;
}

}  // namespace crofton::triangulate
