#include "minimum_weight.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace crofton::triangulate {

Result<bool> MinimumWeight::solve(const Domain& domain, const Options& options, Triangulation& result) {
    (void)options;
    const auto points = domain.mesh().points;
    if (!finder_.find(domain, std::size_t{1} << 31, graph_)) return false;
    find_faces(graph_, CandidateGraph::kConstraint, faces_);
    const auto in_pieces = [](Index size) { return size > 1; };
    if (std::any_of(faces_.component_size.begin(), faces_.component_size.end(), in_pieces)) {
        skeleton_.prune(points, graph_, certificates_);
        skeleton_.mark_certain(domain.mesh(), graph_);
        find_faces(graph_, CandidateGraph::kConstraint | CandidateGraph::kCertain, faces_);
    }
    program_.start(points, graph_);
    corners_.clear();
    diagonals_.clear();
    SearchBudget budget{20000};
    for (Index w = 0; w < faces_.component.size(); ++w) {
        if (faces_.component[w] != w) continue;
        if (faces_.component_size[w] > 1) {
            const auto outcome = search_.solve(points, graph_, faces_, w, budget, corners_, diagonals_);
            if (outcome == FaceSearch::Outcome::gave_up) return false;
            if (outcome == FaceSearch::Outcome::infeasible)
                return fail(ErrorCode::internal, w, "a face has no triangulation");
            continue;
        }
        const auto walk = faces_.walk(w);
        if (walk.size() == 3) {
            corners_.push_back({walk[0], walk[1], walk[2]});
            continue;
        }
        if (!(program_.solve(walk) < std::numeric_limits<double>::infinity())) {
            return fail(ErrorCode::internal, w, "a face has no triangulation");
        }
        program_.append(corners_, diagonals_);
    }
    write(domain, result);
    return true;
}

void MinimumWeight::write(const Domain& domain, Triangulation& result) {
    const auto& points = domain.mesh().points;
    const auto input = [&](Index h) {
        const Index v = graph_.destination[graph_.twin[h]];
        return graph_.input.empty() ? domain.input_of(v) : graph_.input[h];
    };
    result.triangles.reserve(corners_.size());
    for (const auto& c : corners_) result.triangles.push_back({input(c[0]), input(c[1]), input(c[2])});
    double weight = 0.0;
    for (const auto& d : diagonals_) {
        const glm::dvec2 v = points[d.from] - points[d.to];
        weight += std::sqrt(v.x * v.x + v.y * v.y);
    }
    for (Index h = 0; h < graph_.half_edge_count(); ++h) {
        const auto flags = graph_.flags[h] | graph_.flags[graph_.twin[h]];
        if (h > graph_.twin[h] || (flags & CandidateGraph::kLeftOutside) != 0) continue;
        if ((flags & (CandidateGraph::kConstraint | CandidateGraph::kCertain)) == 0) continue;
        const glm::dvec2 v = points[graph_.destination[h]] - points[graph_.destination[graph_.twin[h]]];
        weight += std::sqrt(v.x * v.x + v.y * v.y);
    }
    result.weight = weight * domain.scale();
    result.optimal = true;
    result.gap = 0.0;
}

}  // namespace crofton::triangulate
