// SPDX-License-Identifier: MIT
// Minimum-weight triangulation without any pruning: every bridge to a hole is tried, then Klincsek's O(n³) programme
// over all diagonals that cross nothing. Exponential in the number of holes. For simple polygons with simple disjoint
// holes.
#pragma once
#include <gmpxx.h>

#include <cmath>
#include <crofton/geometry/mesh.hpp>
#include <limits>
#include <vector>

namespace crofton::oracle {

class MinimumWeightReference {
  public:
    explicit MinimumWeightReference(const Polygon& polygon) : points_(polygon.points.begin(), polygon.points.end()) {
        for (std::size_t r = 0; r < polygon.ring_count(); ++r) {
            std::vector<std::size_t> ring;
            const std::size_t begin = r == 0 ? 0 : polygon.ring_ends[r - 1];
            for (std::size_t i = begin; i < polygon.ring_ends[r]; ++i) ring.push_back(i);
            double area = 0.0;
            for (std::size_t i = 0; i < ring.size(); ++i) {
                const auto &p = points_[ring[i]], &q = points_[ring[(i + 1) % ring.size()]];
                area += p.x * q.y - p.y * q.x;
            }
            // The inside lies on the left of every ring.
            if ((area > 0.0) != (r == 0)) std::reverse(ring.begin(), ring.end());
            rings_.push_back(ring);
        }
    }

    // Infinity if there is no triangulation.
    long double solve() {
        const auto rings = rings_;
        return solve(rings);
    }

  private:
    using Rings = std::vector<std::vector<std::size_t>>;

    int orientation(std::size_t a, std::size_t b, std::size_t c) const {
        const auto &p = points_[a], &q = points_[b], &r = points_[c];
        const double det = (p.x - r.x) * (q.y - r.y) - (p.y - r.y) * (q.x - r.x);
        const double size = std::fabs((p.x - r.x) * (q.y - r.y)) + std::fabs((p.y - r.y) * (q.x - r.x));
        if (std::fabs(det) > 1e-14 * size) return det > 0.0 ? 1 : -1;
        const mpq_class px(p.x), py(p.y), qx(q.x), qy(q.y), rx(r.x), ry(r.y);
        return sgn((px - rx) * (qy - ry) - (py - ry) * (qx - rx));
    }
    bool less(std::size_t a, std::size_t b) const {
        return points_[a].x < points_[b].x || (points_[a].x == points_[b].x && points_[a].y < points_[b].y);
    }
    bool between(std::size_t a, std::size_t b, std::size_t c) const {  // c inside the segment ab
        return orientation(a, b, c) == 0 && (less(a, b) ? less(a, c) && less(c, b) : less(b, c) && less(c, a));
    }
    bool crosses_nothing(std::size_t a, std::size_t b, const Rings& rings) const {
        for (const auto& ring : rings) {
            for (std::size_t i = 0; i < ring.size(); ++i) {
                const std::size_t c = ring[i], d = ring[(i + 1) % ring.size()];
                if (between(a, b, c)) return false;
                if (a == c || a == d || b == c || b == d) continue;
                if (orientation(a, b, c) * orientation(a, b, d) < 0 && orientation(c, d, a) * orientation(c, d, b) < 0)
                    return false;
            }
        }
        return true;
    }
    // Whether the direction to `to` points into the corner before → at → after, whose inside lies on the left.
    bool in_corner(std::size_t before, std::size_t at, std::size_t after, std::size_t to) const {
        if (to == before || to == after) return false;
        if (before == after)
            return !(orientation(at, after, to) == 0 && orientation(at, before, to) == 0 && same_side(at, after, to));
        const bool left_of_after = orientation(at, after, to) > 0, right_of_before = orientation(at, before, to) < 0;
        const int turn = orientation(before, at, after);
        if (turn > 0) return left_of_after && right_of_before;
        if (turn == 0 && !same_side(at, before, after)) return left_of_after;
        return left_of_after || right_of_before;
    }
    bool same_side(std::size_t at, std::size_t a, std::size_t b) const {
        return (points_[a].x - points_[at].x) * (points_[b].x - points_[at].x) +
                   (points_[a].y - points_[at].y) * (points_[b].y - points_[at].y) >
               0.0;
    }
    long double length(std::size_t a, std::size_t b) const {
        const long double x = static_cast<long double>(points_[a].x) - points_[b].x;
        const long double y = static_cast<long double>(points_[a].y) - points_[b].y;
        return std::sqrt(x * x + y * y);
    }

    long double solve(const Rings& rings) {
        if (rings.size() == 1) return klincsek(rings[0], rings);
        // The leftmost vertex of the last hole has an edge to something on its left.
        const auto& hole = rings.back();
        std::size_t v = 0;
        for (std::size_t i = 1; i < hole.size(); ++i) v = less(hole[i], hole[v]) ? i : v;
        long double best = std::numeric_limits<long double>::infinity();
        for (std::size_t r = 0; r + 1 < rings.size(); ++r) {
            const auto& ring = rings[r];
            for (std::size_t i = 0; i < ring.size(); ++i) {
                const std::size_t before = ring[(i + ring.size() - 1) % ring.size()],
                                  after = ring[(i + 1) % ring.size()];
                if (!less(ring[i], hole[v]) || !in_corner(before, ring[i], after, hole[v])) continue;
                if (!crosses_nothing(hole[v], ring[i], rings)) continue;
                Rings merged = rings;
                std::vector<std::size_t> joined(ring.begin(), ring.begin() + static_cast<long>(i) + 1);
                for (std::size_t k = 0; k <= hole.size(); ++k) joined.push_back(hole[(v + k) % hole.size()]);
                joined.insert(joined.end(), ring.begin() + static_cast<long>(i), ring.end());
                merged[r] = joined;
                merged.pop_back();
                best = std::min(best, length(hole[v], ring[i]) + solve(merged));
            }
        }
        return best;
    }

    long double klincsek(const std::vector<std::size_t>& walk, const Rings& rings) const {
        const std::size_t n = walk.size();
        const long double infinity = std::numeric_limits<long double>::infinity();
        std::vector<std::vector<long double>> cost(n, std::vector<long double>(n, infinity));
        std::vector<std::vector<char>> allowed(n, std::vector<char>(n, 0));
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = i + 2; j < n; ++j) {
                if (i == 0 && j + 1 == n) continue;
                const auto corner = [&](std::size_t at, std::size_t to) {
                    return in_corner(walk[(at + n - 1) % n], walk[at], walk[(at + 1) % n], walk[to]);
                };
                allowed[i][j] =
                    walk[i] != walk[j] && corner(i, j) && corner(j, i) && crosses_nothing(walk[i], walk[j], rings);
            }
        }
        for (std::size_t i = 0; i + 1 < n; ++i) cost[i][i + 1] = 0.0;
        for (std::size_t span = 2; span < n; ++span) {
            for (std::size_t i = 0; i + span < n; ++i) {
                const std::size_t j = i + span;
                const bool root = span + 1 == n;
                if (!root && !allowed[i][j]) continue;
                for (std::size_t k = i + 1; k < j; ++k) {
                    if (orientation(walk[i], walk[k], walk[j]) <= 0) continue;
                    cost[i][j] =
                        std::min(cost[i][j], cost[i][k] + cost[k][j] + (root ? 0.0L : length(walk[i], walk[j])));
                }
            }
        }
        return cost[0][n - 1];
    }

    std::vector<glm::dvec2> points_;
    Rings rings_;
};

}  // namespace crofton::oracle
