// SPDX-License-Identifier: MIT
#include "minimum_weight/minimum_weight.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/core/select.hpp>
#include <crofton/geometry/predicates.hpp>
#include <limits>
#include <numeric>

namespace crofton::triangulate {
namespace {

// Candidates, their twins, certificates, walks and programme slots, with the growth of their arrays.
constexpr std::size_t kBytesPerHalfEdge = 96;
// The rounding of one operation of a sum, with room for the roots in it.
constexpr double kRounding = 0x1p-50;
constexpr double kPruned = 0.55;  // the share of the work that is done when edges are pruned, as told to the caller
constexpr std::size_t kLongRing = 3000, kFewCandidates = 40;
constexpr std::size_t kBytesPerTriangleSide = 2 * sizeof(TriangleSupport::Lists::Entry);

double length(std::span<const glm::dvec2> points, const Segment& s) {
    const glm::dvec2 d = points[s.from] - points[s.to];
    return std::sqrt(d.x * d.x + d.y * d.y);
}

// Reorders the lengths.
double sum_of_shortest(std::span<double> lengths, std::size_t count) {
    count = std::min(count, lengths.size());
    crofton::detail::select(lengths.begin(), lengths.begin() + static_cast<std::ptrdiff_t>(count), lengths.end(),
                            std::less<>());
    return std::accumulate(lengths.begin(), lengths.begin() + static_cast<std::ptrdiff_t>(count), 0.0);
}

Error cancelled() {
    return fail(ErrorCode::cancelled, kNoItem, "stopped by the caller");
}

}  // namespace

Result<bool> MinimumWeight::solve(const Domain& domain, const TriangulateOptions& options, Watch& watch,
                                  Triangulation& result) {
    lower_bound_ = 0.0;
    proven_ = true;
    corners_.clear();
    diagonals_.clear();
    if (collect_convex_ring(domain, options.bytes)) {
        const double weight = program_.solve_convex(domain.mesh().points, ring_, watch, 0.5);
        if (watch.cancelled()) return cancelled();
        if (weight < std::numeric_limits<double>::infinity()) {
            finish_convex(domain, result);
            return true;
        }
        bound_whole(domain, false);
        return false;
    }
    const bool candidates = finder_.find(domain, options.bytes / kBytesPerHalfEdge, watch, graph_);
    const bool faces = candidates && divide_into_faces(domain, options, watch);
    if (watch.cancelled()) return cancelled();
    if (!faces) {
        bound_whole(domain, candidates);
        return false;
    }
    if (infeasible_) return fail(ErrorCode::internal, kNoItem, "a side of the polygon has no triangle");
    const auto points = domain.mesh().points;
    program_.start(points, graph_);
    unsolved_.clear();
    const auto count = static_cast<Index>(faces_.component.size());
    for (Index w = 0; w < count; ++w) {
        if (faces_.component[w] != w) continue;
        const auto outcome = solve_face(points, w, watch, 0.6 + 0.4 * w / count);
        if (watch.cancelled()) return cancelled();
        if (outcome == FaceSearch::Outcome::infeasible)
            return fail(ErrorCode::internal, w, "a face has no triangulation");
        if (outcome == FaceSearch::Outcome::gave_up) gave_up_ = true;
    }
    const bool complete = !gave_up_;
    bound_unsolved(points);
    finish(domain, complete, result);
    return complete;
}

// The vertices of a strictly convex polygon counter-clockwise, from the first one; false for others. No diagonal of it
// can be excluded by its neighbourhood, so the programme needs no candidates.
bool MinimumWeight::collect_convex_ring(const Domain& domain, std::size_t bytes) {
    const auto points = domain.mesh().points;
    const auto count = static_cast<Index>(points.size());
    if (domain.ring_count() != 1 || domain.has_shared_positions() || IntervalProgram::convex_bytes(count) > bytes)
        return false;
    const auto corner = [&](Index i) { return domain.vertex_of(i % count); };
    const auto turn = [&](Index i) {
        return orientation(points[corner(i)], points[corner(i + 1)], points[corner(i + 2)]);
    };
    const int side = turn(0);
    if (side == 0) return false;
    for (Index i = 1; i < count; ++i)
        if (turn(i) != side) return false;
    // A ring that touches itself may go round twice and turn to one side all the way: each round has a lowest corner.
    const auto precedes = [&](Index i, Index j) {
        const auto &p = points[corner(i)], &q = points[corner(j)];
        return p.x < q.x || (p.x == q.x && p.y < q.y);
    };
    Index rounds = 0;
    for (Index i = 0; i < count; ++i) rounds += precedes(i + 1, i) && precedes(i + 1, i + 2);
    if (rounds != 1) return false;
    const Index start = domain.input_of(0);
    ring_.resize(count);
    for (Index i = 0; i < count; ++i) ring_[i] = corner(side > 0 ? start + i : start + count - i);
    return true;
}

void MinimumWeight::finish_convex(const Domain& domain, Triangulation& result) {
    const auto points = domain.mesh().points;
    const auto input = [&](Index corner) { return domain.input_of(ring_[corner]); };
    double weight = 0.0;
    result.triangles.reserve(ring_.size() - 2);
    program_.for_each_triangle([&](Index low, Index middle, Index high) {
        result.triangles.push_back({input(low), input(middle), input(high)});
        if (middle != low + 1) weight += length(points, {ring_[low], ring_[middle]});
        if (high != middle + 1) weight += length(points, {ring_[middle], ring_[high]});
    });
    result.weight = weight * domain.scale();
    result.optimal = true;
    result.gap = 0.0;
}

// Returns false if the watch stops before the certain edges are known.
bool MinimumWeight::divide_into_faces(const Domain& domain, const TriangulateOptions& options, Watch& watch) {
    const auto points = domain.mesh().points;
    infeasible_ = gave_up_ = false;
    // Long rings with few candidates are pruned too, which shortens the lists of the programme.
    const bool long_ring =
        domain.vertex_count() > kLongRing && graph_.half_edge_count() < kFewCandidates * domain.vertex_count();
    const bool prune = domain.ring_count() > 1 || long_ring;
    if (!prune) find_faces(graph_, CandidateGraph::kConstraint, faces_);
    if (prune || has_pieces()) {
        skeleton_.prune(points, graph_, watch);
        if (watch.stopped_now(kPruned) || !skeleton_.mark_certain(domain.mesh(), graph_, watch)) return false;
        find_faces(graph_, CandidateGraph::kFixed, faces_);
    }
    if (has_pieces()) {
        mark_simple_faces();
        infeasible_ = !support_.build(points, graph_, options.bytes / kBytesPerTriangleSide, watch, lists_);
        // The faces found before are a valid division, too.
        if (infeasible_ || watch.stopped_now(kPruned) || !skeleton_.mark_certain(domain.mesh(), graph_, watch))
            return true;
        find_faces(graph_, CandidateGraph::kFixed, faces_);
    }
    return true;
}

bool MinimumWeight::has_pieces() const {
    const auto in_pieces = [](Index size) { return size > 1; };
    return std::any_of(faces_.component_size.begin(), faces_.component_size.end(), in_pieces);
}

// The interval programme needs no help with them.
void MinimumWeight::mark_simple_faces() {
    for (Index h = 0; h < graph_.half_edge_count(); ++h) {
        const Index walk = faces_.walk_of[h];
        if (walk != kNone && faces_.component_size[faces_.component[walk]] == 1)
            graph_.flags[h] |= CandidateGraph::kLeftSimple;
    }
}

FaceSearch::Outcome MinimumWeight::solve_face(std::span<const glm::dvec2> points, Index name, Watch& watch,
                                              double fraction) {
    using Outcome = FaceSearch::Outcome;
    const bool simple = faces_.component_size[name] == 1;
    if (simple && faces_.walk(name).size() == 3) {
        const auto walk = faces_.walk(name);
        corners_.push_back({walk[0], walk[1], walk[2]});
        return Outcome::solved;
    }
    const std::size_t before = diagonals_.size();
    Outcome outcome = Outcome::gave_up;
    if (!simple && !watch.stopped_now(fraction)) {
        outcome = search_.solve(points, graph_, faces_, name, watch, corners_, diagonals_);
    } else if (simple && !watch.stopped(fraction, 1)) {
        const double weight = program_.solve(faces_.walk(name), watch, fraction);
        if (weight < std::numeric_limits<double>::infinity()) {
            program_.append(corners_, diagonals_);
            outcome = Outcome::solved;
        } else if (!watch.stopped_now(fraction)) {
            outcome = Outcome::infeasible;
        }
    }
    if (outcome == Outcome::solved) {
        for (std::size_t i = before; i < diagonals_.size(); ++i) lower_bound_ += length(points, diagonals_[i]);
    } else {
        proven_ = false;
        unsolved_.push_back(name);
    }
    return outcome;
}

// Without faces: all diagonals are different candidates, of which there are at least as many as the shortest.
void MinimumWeight::bound_whole(const Domain& domain, bool candidates) {
    const auto& mesh = domain.mesh();
    double bound = delaunay_bound_.weight(domain), slits = 0.0;
    if (candidates) {
        std::size_t diagonals = 0;
        for (Index e = 0; e < mesh.origin.size(); ++e) {
            if ((e & 3u) == 3u || mesh.twin[e] == kNone || e > mesh.twin[e]) continue;
            if (!domain.inside(e / 4) || !domain.inside(mesh.twin[e] / 4)) continue;
            if (mesh.mark[e] == 0)
                ++diagonals;
            else
                slits += length(mesh.points, {mesh.origin[e], mesh.destination(e)});
        }
        lengths_.clear();
        for (Index h = 0; h < graph_.half_edge_count(); ++h) {
            if ((graph_.flags[h] & (CandidateGraph::kFixed | CandidateGraph::kDead)) != 0 || h > graph_.twin[h])
                continue;
            lengths_.push_back(length(mesh.points, {graph_.destination[h], graph_.destination[graph_.twin[h]]}));
        }
        bound = std::max(bound, slits + sum_of_shortest(lengths_, diagonals));
    }
    lower_bound_ = bound * (1.0 - kRounding * static_cast<double>(mesh.points.size() + 16)) * domain.scale();
    bound_by_arcs(domain, candidates);
}

void MinimumWeight::bound_by_arcs(const Domain& domain, bool candidates) {
    const double bound = arc_bound_.weight(domain, candidates ? &graph_ : nullptr);
    const double kept = 1.0 - kRounding * static_cast<double>(domain.mesh().points.size() + 16);
    lower_bound_ = std::max(lower_bound_, bound * kept * domain.scale());
}

// A face with m sides in p pieces has t = m − 2 + 2(p − 1) triangles and (3t − m)/2 diagonals, all different
// candidates.
void MinimumWeight::bound_unsolved(std::span<const glm::dvec2> points) {
    if (unsolved_.empty()) return;
    struct Face {
        Index sides = 0, begin = 0, end = 0;
    };
    Vector<Face> faces(faces_.component.size());
    for (std::size_t w = 0; w < faces_.walk_count(); ++w)
        faces[faces_.component[w]].sides += static_cast<Index>(faces_.walk(w).size());
    const auto face_of = [&](Index h) {
        const bool open =
            (graph_.flags[h] & (CandidateGraph::kFixed | CandidateGraph::kDead)) == 0 && h < graph_.twin[h];
        return open && faces_.walk_of[h] != kNone ? faces_.component[faces_.walk_of[h]] : kNone;
    };
    for (Index h = 0; h < graph_.half_edge_count(); ++h) {
        if (const Index face = face_of(h); face != kNone) ++faces[face].end;
    }
    Index total = 0;
    for (Face& face : faces) {
        face.begin = total;
        total += face.end;
        face.end = face.begin;
    }
    lengths_.resize(total);
    for (Index h = 0; h < graph_.half_edge_count(); ++h) {
        if (const Index face = face_of(h); face != kNone)
            lengths_[faces[face].end++] = length(points, {graph_.destination[h], graph_.destination[graph_.twin[h]]});
    }
    for (const Index name : unsolved_) {
        const Face& face = faces[name];
        const std::size_t triangles = face.sides - 2 + 2 * (faces_.component_size[name] - 1);
        lower_bound_ += sum_of_shortest(std::span(lengths_).subspan(face.begin, face.end - face.begin),
                                        (3 * triangles - face.sides) / 2);
    }
}

void MinimumWeight::finish(const Domain& domain, bool complete, Triangulation& result) {
    const auto points = domain.mesh().points;
    const std::size_t inside_faces = diagonals_.size();
    double weight = 0.0;
    for (Index h = 0; h < graph_.half_edge_count(); ++h) {
        const auto flags = graph_.flags[h] | graph_.flags[graph_.twin[h]];
        if (h > graph_.twin[h] || (flags & CandidateGraph::kLeftOutside) != 0 || (flags & CandidateGraph::kFixed) == 0)
            continue;
        const Segment edge{graph_.destination[h], graph_.destination[graph_.twin[h]]};
        weight += length(points, edge);
        if (!complete) diagonals_.push_back(edge);
    }
    // Rounding of all sums below; what is proven keeps this distance.
    const double kept = 1.0 - kRounding * (static_cast<double>(diagonals_.size() + lengths_.size()) + 64.0);
    lower_bound_ = (lower_bound_ + weight) * kept * domain.scale();
    if (!proven_) bound_by_arcs(domain, true);
    if (!complete) return;
    const auto input = [&](Index h) {
        return graph_.input.empty() ? domain.input_of(graph_.destination[graph_.twin[h]]) : graph_.input[h];
    };
    result.triangles.reserve(corners_.size());
    for (const auto& c : corners_) result.triangles.push_back({input(c[0]), input(c[1]), input(c[2])});
    for (std::size_t i = 0; i < inside_faces; ++i) weight += length(points, diagonals_[i]);
    result.weight = weight * domain.scale();
    result.optimal = proven_;
    result.gap = proven_ ? 0.0 : gap_of(result.weight);
}

}  // namespace crofton::triangulate
