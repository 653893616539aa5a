// SPDX-License-Identifier: MIT
#include "minimum_weight/length_bounds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/geometry/finite.hpp>

namespace crofton::triangulate {
namespace {

constexpr int kMostLooks = 64;

double square(const glm::dvec2& v) {
    return v.x * v.x + v.y * v.y;
}

// From p to segment ab, rounded down: the cross product errs by less than 2^-50 |pa| |pb|.
double square_distance(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
    const glm::dvec2 pa = a - p, pb = b - p, ab = b - a;
    const double aa = square(pa), bb = square(pb);
    if (pa.x * ab.x + pa.y * ab.y >= 0.0) return aa;
    if (pb.x * ab.x + pb.y * ab.y <= 0.0) return bb;
    const double area = std::max(0.0, std::fabs(pa.x * pb.y - pa.y * pb.x) - 0x1p-50 * std::sqrt(aa * bb));
    return area * area / square(ab);
}

}  // namespace

// A vertex's bound is a lower bound on the length of its diagonals. Among the k vertices of least bound the diagonals
// and the b(k) sides that join them form a planar graph of at most 3k edges, and a diagonal shorter than the next
// vertex's bound joins two of them. So, in order of length, the diagonals from number 3k − b(k) on, counted from 0, are
// at least as long as that.
double DelaunayBound::weight(const Domain& domain) {
    measure(domain);
    rank();
    double sum = slits_;
    std::size_t placed = 0, allowed = 0;
    for (std::size_t k = 0; k < order_.size() && placed < diagonals_; ++k) {
        // With the first k + 1 vertices.
        allowed += 3;
        allowed -= std::min<std::size_t>(allowed, closed_[k]);
        const std::size_t end = std::min(diagonals_, allowed);
        if (end <= placed) continue;
        sum += static_cast<double>(end - placed) * shortest_[order_[k]];
        placed = end;
    }
    return sum;
}

void DelaunayBound::measure(const Domain& domain) {
    const auto& mesh = domain.mesh();
    shortest_.resize(mesh.points.size());
    for (Index v = 0; v < shortest_.size(); ++v) shortest_[v] = shortest_diagonal(domain, v);
    sides_.clear();
    slits_ = 0.0;
    diagonals_ = 0;
    for (Index e = 0; e < mesh.origin.size(); ++e) {
        if ((e & 3u) == 3u || !domain.inside(e / 4)) continue;
        const Index twin = mesh.twin[e];
        const bool shared = twin != kNone && domain.inside(twin / 4);
        if (mesh.mark[e] == 0) {
            diagonals_ += e < twin;
        } else if (!shared || e < twin) {
            sides_.push_back({mesh.origin[e], mesh.destination(e)});
            if (shared) slits_ += std::sqrt(square(mesh.points[mesh.origin[e]] - mesh.points[mesh.destination(e)]));
        }
    }
}

// A lower bound on the length of v's diagonals: the distance to the nearest vertex that is not joined to v by a side
// and that triangles join to v, seen or not. What is not looked through is as far as the nearest point of its
// edge.
double DelaunayBound::shortest_diagonal(const Domain& domain, Index v) {
    const auto& mesh = domain.mesh();
    const glm::dvec2 eye = mesh.points[v];
    double best = kInfinity;
    std::array<Index, 4> joined;
    std::size_t joined_count = 0;
    const auto meet = [&](Index w) {
        const auto end = joined.begin() + static_cast<std::ptrdiff_t>(joined_count);
        if (std::find(joined.begin(), end, w) == end) best = std::min(best, square(mesh.points[w] - eye));
    };
    const auto meet_along = [&](Index e, Index w) {
        if (mesh.mark[e] == 0)
            meet(w);
        else if (joined_count < joined.size())
            joined[joined_count++] = w;
    };
    open_.clear();
    const Index start = mesh.vertex_edge[v];
    for (Index e = start; e != kNone;) {
        if (domain.inside(e / 4)) {
            meet_along(e, mesh.destination(e));
            meet_along(previous(e), mesh.apex(e));
            if (mesh.mark[next(e)] == 0) open_.push_back(next(e));
        }
        e = mesh.rotate(e);
        if (e == start) break;
    }
    for (int looks = 0; !open_.empty(); ++looks) {
        const Index e = open_.back();
        open_.pop_back();
        const double distance = square_distance(eye, mesh.points[mesh.origin[e]], mesh.points[mesh.destination(e)]);
        if (distance >= best) continue;
        if (looks >= kMostLooks) {
            best = distance;
            continue;
        }
        const Index beyond = mesh.twin[e];
        meet(mesh.apex(beyond));
        for (const Index side : {next(beyond), previous(beyond)}) {
            if (mesh.mark[side] == 0) open_.push_back(side);
        }
    }
    return std::sqrt(best);
}

// Sorts the vertices that have diagonals by their bounds, and counts the sides that each closes with earlier ones.
void DelaunayBound::rank() {
    order_.clear();
    rank_.assign(shortest_.size(), kNone);
    for (Index v = 0; v < shortest_.size(); ++v) {
        if (shortest_[v] < kInfinity) order_.push_back(v);
    }
    std::sort(order_.begin(), order_.end(),
              [&](Index a, Index b) { return shortest_[a] != shortest_[b] ? shortest_[a] < shortest_[b] : a < b; });
    for (Index k = 0; k < order_.size(); ++k) rank_[order_[k]] = k;
    closed_.assign(order_.size(), 0);
    for (const Side& s : sides_) {
        if (rank_[s.from] != kNone && rank_[s.to] != kNone) ++closed_[std::max(rank_[s.from], rank_[s.to])];
    }
}

}  // namespace crofton::triangulate
