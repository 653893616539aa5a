#include "length_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace crofton::triangulate {

// Among the k vertices of the shortest reach the diagonals and the b(k) sides that join them form a planar graph of at
// most 3k edges, and a diagonal shorter than the reach of the next vertex joins two of them. So, in order of length,
// the diagonals from number 3k − b(k) on, counted from 0, are at least as long as that.
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
        sum += static_cast<double>(end - placed) * reach_[order_[k]];
        placed = end;
    }
    return sum;
}

// Of what is seen from a vertex through the opposite side of a Delaunay triangle there, nothing lies inside the
// triangle's circle, and the chords from the vertex through the opposite side are at least as long as the shorter of
// the triangle's sides at the vertex.
void DelaunayBound::measure(const Domain& domain) {
    const auto& mesh = domain.mesh();
    reach_.assign(mesh.points.size(), std::numeric_limits<double>::infinity());
    sides_.clear();
    slits_ = 0.0;
    diagonals_ = 0;
    const auto length = [&](Index e) {
        const glm::dvec2 d = mesh.points[mesh.origin[e]] - mesh.points[mesh.destination(e)];
        return std::sqrt(d.x * d.x + d.y * d.y);
    };
    for (Index t = 0; t < mesh.triangle_count(); ++t) {
        if (!domain.inside(t)) continue;
        for (Index e = 4 * t; e < 4 * t + 3; ++e) {
            const Index u = mesh.origin[e], w = mesh.destination(e), twin = mesh.twin[e];
            const double here = length(e);
            const bool shared = twin != kNone && domain.inside(twin / 4);
            if (mesh.mark[e] == 0) {
                diagonals_ += e < twin;
                reach_[u] = std::min(reach_[u], here);
                reach_[w] = std::min(reach_[w], here);
            } else if (!shared || e < twin) {
                sides_.push_back({u, w});
                if (shared) slits_ += here;
            }
            if (mesh.mark[next(e)] == 0) reach_[u] = std::min({reach_[u], here, length(previous(e))});
        }
    }
}

// Sorts the vertices that have diagonals by reach, and counts the sides that each closes with earlier ones.
void DelaunayBound::rank() {
    order_.clear();
    rank_.assign(reach_.size(), kNone);
    for (Index v = 0; v < reach_.size(); ++v) {
        if (reach_[v] < std::numeric_limits<double>::infinity()) order_.push_back(v);
    }
    std::sort(order_.begin(), order_.end(),
              [&](Index a, Index b) { return reach_[a] != reach_[b] ? reach_[a] < reach_[b] : a < b; });
    for (Index k = 0; k < order_.size(); ++k) rank_[order_[k]] = k;
    closed_.assign(order_.size(), 0);
    for (const Side& s : sides_) {
        if (rank_[s.from] != kNone && rank_[s.to] != kNone) ++closed_[std::max(rank_[s.from], rank_[s.to])];
    }
}

}  // namespace crofton::triangulate
