// SPDX-License-Identifier: MIT
#include "minimum_weight/lmt_skeleton.hpp"

#include <algorithm>
#include <crofton/geometry/predicates.hpp>

#include "minimum_weight/local_minimality.hpp"

namespace crofton::triangulate {
namespace {
constexpr double kFraction = 0.5;  // the share of the work that is done, as told to the caller
constexpr std::uint8_t kPlaced = CandidateGraph::kCertain | CandidateGraph::kLeftSimple;
constexpr std::uint8_t kDecided = CandidateGraph::kConstraint | CandidateGraph::kDead;
}  // namespace

void LmtSkeleton::prune(std::span<const glm::dvec2> points, CandidateGraph& graph, Watch& watch) {
    points_ = points;
    graph_ = &graph;
    mesh_ = nullptr;
    // Stamps only grow, so they stay clean between runs.
    if (stamp_.size() < graph.vertex_count()) stamp_.resize(graph.vertex_count(), 0);
    certificates_.assign(graph.half_edge_count(), {});
    changed_.assign(graph.vertex_count(), 1);
    for (bool again = true; again;) {
        again = false;
        for (Index p = 0; p < graph.vertex_count(); ++p) {
            if (changed_[p] == 0) continue;
            again = true;
            changed_[p] = 0;
            look_around(p, watch);
            if (watch.stopped(kFraction, 1)) return;
        }
    }
}

// Certifies the edges of p whose certificate has lost an edge at p, and kills those that have none.
void LmtSkeleton::look_around(Index p, Watch& watch) {
    auto& g = *graph_;
    stamp(p);
    for (Index h = g.first[p], end = g.first[p + 1]; h < end; ++h) {
        if ((g.flags[h] & kDecided) != 0) continue;
        const Certificate c = certificates_[h];
        const bool stands = c.left != kNone && stamp_[c.left] == stamp_value_ && stamp_[c.right] == stamp_value_;
        if (stands) continue;
        const Index q = g.destination[h];
        if (watch.stopped(kFraction, g.first[q + 1] - g.first[q])) return;
        if (certify(h)) continue;
        g.flags[h] |= CandidateGraph::kDead;
        g.flags[g.twin[h]] |= CandidateGraph::kDead;
        stamp_[q] = 0;
        changed_[p] = changed_[q] = 1;
    }
}

// Marks the living neighbours of p.
void LmtSkeleton::stamp(Index p) {
    const auto& g = *graph_;
    ++stamp_value_;
    for (Index k = g.first[p]; k < g.first[p + 1]; ++k) {
        if (alive(k)) stamp_[g.destination[k]] = stamp_value_;
    }
}

// Looks for a common neighbour on each side that makes h, whose origin's neighbours are stamped, locally minimal. Which
// neighbours are common and on which side they lie is hard to predict: every one is written, and few are kept.
bool LmtSkeleton::certify(Index h) {
    const auto& g = *graph_;
    const Index p = origin(h), q = g.destination[h];
    const Index begin = g.first[q], end = g.first[q + 1];
    if (common_.size() < end - begin) {
        for (auto* list : {&common_, &left_, &right_}) list->resize(end - begin);
    }
    std::size_t common = 0, lefts = 0, rights = 0;
    // Local copies, or every write would make the compiler read the members again.
    const Index* const destination = g.destination.data();
    const std::uint8_t* const flags = g.flags.data();
    const Index* const stamps = stamp_.data();
    const Index value = stamp_value_;
    Index *const commons = common_.data(), *const left = left_.data(), *const right = right_.data();
    for (Index k = begin; k < end; ++k) {
        const Index s = destination[k];
        commons[common] = s;
        common += (stamps[s] == value) & ((flags[k] & CandidateGraph::kDead) == 0);
    }
    const auto points = points_;
    const glm::dvec2 a = points[p], b = points[q];
    for (std::size_t i = 0; i < common; ++i) {
        const Index s = commons[i];
        const int side = orientation(a, b, points[s]);
        left[lefts] = right[rights] = s;
        lefts += side > 0;
        rights += side < 0;
    }
    for (std::size_t l = 0; l < lefts; ++l) {
        for (std::size_t r = 0; r < rights; ++r) {
            if (locally_minimal(points, p, q, left[l], right[r])) {
                certificates_[h] = certificates_[g.twin[h]] = {left[l], right[r]};
                return true;
            }
        }
    }
    return false;
}

// Living Delaunay edges cross only others, which are walked through the Delaunay triangles. Almost all of them cross a
// living Delaunay edge; only triangles with one that does not are searched for crossings inside.
bool LmtSkeleton::mark_certain(const HalfEdgeMesh& mesh, CandidateGraph& graph, Watch& watch) {
    graph_ = &graph;
    points_ = mesh.points;
    auto& g = graph;
    const auto count = static_cast<Index>(g.half_edge_count());
    if (mesh_ == nullptr) {
        mesh_ = &mesh;
        find_delaunay();
    }
    crossed_.assign(count, 0);
    if (!cross_chords(watch) || !cross_lonely_chords(watch)) return false;
    for (Index h = 0; h < count; ++h) {
        if (alive(h) && (g.flags[h] & kPlaced) == 0 && !crossed_[h] && !crossed_[g.twin[h]])
            g.flags[h] |= CandidateGraph::kCertain;
    }
    return true;
}

bool LmtSkeleton::is_chord(Index h) const {
    return h < graph_->twin[h] && alive(h) && (graph_->flags[h] & (CandidateGraph::kDelaunay | kPlaced)) == 0;
}

bool LmtSkeleton::cross_chords(Watch& watch) {
    for (Index h = 0; h < crossed_.size(); ++h) {
        std::size_t steps = 0;
        if (!is_chord(h)) continue;
        walk(h, [&](Index, Index crossing) {
            cross_delaunay(h, crossing);
            ++steps;
        });
        if (watch.stopped(kFraction, steps)) return false;
    }
    return true;
}

bool LmtSkeleton::cross_lonely_chords(Watch& watch) {
    const auto& g = *graph_;
    lonely_.clear();
    for (Index h = 0; h < crossed_.size(); ++h) {
        if (is_chord(h) && !crossed_[h]) lonely_.push_back(h);
    }
    if (lonely_.empty()) return true;
    chord_head_.assign(mesh_->triangle_count(), kNone);
    chords_.clear();
    for (const Index h : lonely_) walk(h, [&](Index triangle, Index) { chord_head_[triangle] = kEmptyList; });
    for (Index h = 0; h < crossed_.size(); ++h) {
        std::size_t steps = 0;
        if (!is_chord(h)) continue;
        walk(h, [&](Index triangle, Index) {
            ++steps;
            if (chord_head_[triangle] == kNone) return;
            chords_.push_back({h, chord_head_[triangle]});
            chord_head_[triangle] = static_cast<Index>(chords_.size() - 1);
        });
        if (watch.stopped(kFraction, steps)) return false;
    }
    for (const Index h : lonely_) {
        std::size_t steps = 0;
        walk(h, [&](Index triangle, Index) {
            for (Index i = chord_head_[triangle]; i != kEmptyList && !crossed_[h]; i = chords_[i].next) {
                const Index k = chords_[i].half_edge;
                ++steps;
                if (candidates_cross(points_, origin(h), g.destination[h], origin(k), g.destination[k]))
                    crossed_[h] = 1;
            }
        });
        if (watch.stopped(kFraction, steps)) return false;
    }
    return true;
}

// graph_edge_[e] is the graph's half-edge for the mesh's e, where it is a candidate.
void LmtSkeleton::find_delaunay() {
    const auto& g = *graph_;
    graph_edge_.assign(mesh_->origin.size(), kNone);
    for (Index e = 0; e < mesh_->origin.size(); ++e) {
        if ((e & 3u) == 3u || mesh_->twin[e] == kNone || e > mesh_->twin[e]) continue;
        const Index u = mesh_->origin[e], w = mesh_->destination(e);
        Index k = g.first[u];
        while (k < g.first[u + 1] && g.destination[k] != w) ++k;
        if (k == g.first[u + 1]) continue;
        graph_edge_[e] = k;
        graph_edge_[mesh_->twin[e]] = g.twin[k];
    }
}

void LmtSkeleton::cross_delaunay(Index h, Index crossing) {
    if (crossing == kNone || graph_edge_[crossing] == kNone || !alive(graph_edge_[crossing])) return;
    const Index k = graph_edge_[crossing];
    crossed_[k] = crossed_[graph_->twin[k]] = crossed_[h] = 1;
}

// Calls visit(triangle, edge by which the chord leaves it or kNone) from end to end.
template <class Visit>
void LmtSkeleton::walk(Index h, Visit visit) const {
    const auto& g = *graph_;
    const Index p = origin(h), q = g.destination[h];
    const auto &from = mesh_->points[p], &to = mesh_->points[q];
    Index e = mesh_->vertex_edge[p];
    while (orientation(from, to, mesh_->points[mesh_->destination(e)]) >= 0 ||
           orientation(from, to, mesh_->points[mesh_->apex(e)]) <= 0) {
        e = mesh_->rotate(e);
    }
    for (Index crossing = next(e);;) {
        visit(crossing / 4, crossing);
        e = mesh_->twin[crossing];
        const Index apex = mesh_->apex(e);
        if (apex == q) return visit(e / 4, kNone);
        // e runs from the left side to the right one.
        crossing = orientation(from, to, mesh_->points[apex]) > 0 ? next(e) : previous(e);
    }
}

}  // namespace crofton::triangulate
