#include "minimum_weight.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace crofton::triangulate {
namespace {

constexpr std::uint8_t kFixed = CandidateGraph::kConstraint | CandidateGraph::kCertain;
// Candidates, their twins, certificates, walks and programme slots, with the growth of their arrays.
constexpr std::size_t kBytesPerHalfEdge = 96;
constexpr std::size_t kLongRing = 3000, kFewCandidates = 40;
constexpr std::size_t kBytesPerTriangleSide = 2 * sizeof(TriangleSupport::Lists::Entry);

double length(std::span<const glm::dvec2> points, const Segment& s) {
    const glm::dvec2 d = points[s.from] - points[s.to];
    return std::sqrt(d.x * d.x + d.y * d.y);
}

}  // namespace

Result<bool> MinimumWeight::solve(const Domain& domain, const Options& options, Triangulation& result) {
    Watch watch(options);
    lower_bound_ = 0.0;
    proven_ = true;
    corners_.clear();
    diagonals_.clear();
    const auto cancelled = [] { return fail(ErrorCode::cancelled, kNoItem, "cancelled by the progress callback"); };
    if (!finder_.find(domain, options.bytes / kBytesPerHalfEdge, watch, graph_)) {
        if (watch.cancelled()) return cancelled();
        return false;
    }
    const auto points = domain.mesh().points;
    // Long rings with few candidates are pruned too: sums of thousands of lengths that tie are costly to compare.
    const bool long_ring =
        domain.vertex_count() > kLongRing && graph_.half_edge_count() < kFewCandidates * domain.vertex_count();
    const bool prune = domain.ring_count() > 1 || long_ring;
    if (!prune) find_faces(graph_, CandidateGraph::kConstraint, faces_);
    if (prune || has_pieces()) {
        skeleton_.prune(points, graph_, watch);
        skeleton_.mark_certain(domain.mesh(), graph_);
        find_faces(graph_, kFixed, faces_);
    }
    if (has_pieces()) {
        settle_simple_faces();
        if (!support_.build(points, graph_, options.bytes / kBytesPerTriangleSide, watch, lists_))
            return fail(ErrorCode::internal, kNoItem, "a side of the polygon has no triangle");
        skeleton_.mark_certain(domain.mesh(), graph_);
        find_faces(graph_, kFixed, faces_);
    }
    program_.start(points, graph_);
    bool complete = true;
    const auto count = static_cast<Index>(faces_.component.size());
    for (Index w = 0; w < count; ++w) {
        if (faces_.component[w] != w) continue;
        const auto outcome = solve_face(points, w, watch, 0.6 + 0.4 * w / count);
        if (watch.cancelled()) return cancelled();
        if (outcome == FaceSearch::Outcome::infeasible)
            return fail(ErrorCode::internal, w, "a face has no triangulation");
        if (outcome == FaceSearch::Outcome::gave_up) complete = false;
    }
    finish(domain, complete, result);
    return complete;
}

bool MinimumWeight::has_pieces() const {
    const auto in_pieces = [](Index size) { return size > 1; };
    return std::any_of(faces_.component_size.begin(), faces_.component_size.end(), in_pieces);
}

// The interval programme needs no help with them.
void MinimumWeight::settle_simple_faces() {
    for (Index h = 0; h < graph_.half_edge_count(); ++h) {
        const Index walk = faces_.walk_of[h];
        if (walk != kNone && faces_.component_size[faces_.component[walk]] == 1)
            graph_.flags[h] |= CandidateGraph::kLeftSettled;
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
    // A search once begun goes on to its first triangulation, so none begins late.
    if (!simple && watch.stopped_now(fraction)) {
        outcome = Outcome::gave_up;
    } else if (!simple) {
        outcome = search_.solve(points, graph_, faces_, name, watch, corners_, diagonals_);
    } else if (!watch.stopped(fraction)) {
        const double weight = program_.solve(faces_.walk(name), watch, fraction);
        if (weight < std::numeric_limits<double>::infinity()) {
            program_.append(corners_, diagonals_);
            outcome = Outcome::solved;
        } else if (!watch.stopped(fraction)) {
            outcome = Outcome::infeasible;
        }
    }
    if (outcome == Outcome::solved) {
        for (std::size_t i = before; i < diagonals_.size(); ++i) lower_bound_ += length(points, diagonals_[i]);
    } else {
        proven_ = false;
        lower_bound_ += face_lower_bound(points, name);
    }
    return outcome;
}

// A face with m sides in p pieces has t = m − 2 + 2(p − 1) triangles and (3t − m)/2 diagonals, all different
// candidates.
double MinimumWeight::face_lower_bound(std::span<const glm::dvec2> points, Index name) {
    std::size_t sides = 0;
    for (std::size_t w = 0; w < faces_.walk_count(); ++w) {
        if (faces_.component[w] == name) sides += faces_.walk(w).size();
    }
    const std::size_t triangles = sides - 2 + 2 * (faces_.component_size[name] - 1);
    lengths_.clear();
    for (Index h = 0; h < graph_.half_edge_count(); ++h) {
        if ((graph_.flags[h] & (kFixed | CandidateGraph::kDead)) != 0 || h > graph_.twin[h]) continue;
        if (faces_.walk_of[h] == kNone || faces_.component[faces_.walk_of[h]] != name) continue;
        lengths_.push_back(length(points, {graph_.destination[h], graph_.destination[graph_.twin[h]]}));
    }
    const std::size_t diagonals = std::min((3 * triangles - sides) / 2, lengths_.size());
    std::nth_element(lengths_.begin(), lengths_.begin() + static_cast<std::ptrdiff_t>(diagonals), lengths_.end());
    double sum = 0.0;
    for (std::size_t i = 0; i < diagonals; ++i) sum += lengths_[i];
    return sum;
}

void MinimumWeight::finish(const Domain& domain, bool complete, Triangulation& result) {
    const auto points = domain.mesh().points;
    const std::size_t inside_faces = diagonals_.size();
    double weight = 0.0;
    for (Index h = 0; h < graph_.half_edge_count(); ++h) {
        const auto flags = graph_.flags[h] | graph_.flags[graph_.twin[h]];
        if (h > graph_.twin[h] || (flags & CandidateGraph::kLeftOutside) != 0 || (flags & kFixed) == 0) continue;
        const Segment edge{graph_.destination[h], graph_.destination[graph_.twin[h]]};
        weight += length(points, edge);
        if (!complete) diagonals_.push_back(edge);
    }
    // Rounding of all sums below; what is proven keeps this distance.
    const double slack = 1.0 - 0x1p-50 * (static_cast<double>(diagonals_.size()) + 64.0);
    lower_bound_ = (lower_bound_ + weight) * slack * domain.scale();
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
