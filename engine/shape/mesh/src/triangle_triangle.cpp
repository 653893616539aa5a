// SPDX-License-Identifier: MIT
// Overlap of two triangles, exactly.
#include <algorithm>
#include <cmath>
#include <crofton/geometry/plane_filter.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "exact_signs.hpp"

namespace crofton::mesh {
namespace {

bool ranges_meet(double a, double b, double c, double d) {
    return std::max(std::min(a, b), std::min(c, d)) <= std::min(std::max(a, b), std::max(c, d));
}

bool segments_meet_2d(const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& a, const glm::dvec3& b, int i,
                      int j) {
    if (!ranges_meet(p[i], q[i], a[i], b[i]) || !ranges_meet(p[j], q[j], a[j], b[j])) return false;
    return orientation_2d(p, q, a, i, j) * orientation_2d(p, q, b, i, j) <= 0 &&
           orientation_2d(a, b, p, i, j) * orientation_2d(a, b, q, i, j) <= 0;
}

bool segment_meets_triangle_2d(const glm::dvec3& p, const glm::dvec3& q, const Triangle& t, int i, int j) {
    for (std::size_t k = 0; k < 3; ++k)
        if (segments_meet_2d(p, q, t[k], t[(k + 1) % 3], i, j)) return true;
    const int turn = orientation_2d(t[0], t[1], t[2], i, j);
    if (turn == 0) return false;  // a segment: its edges have answered
    for (std::size_t k = 0; k < 3; ++k)
        if (orientation_2d(t[k], t[(k + 1) % 3], p, i, j) * turn < 0) return false;
    return true;
}

// All on one plane: they meet iff their projections to all three coordinate planes do. One of these is one-to-one on
// the common plane; the others only lose distinctions.
bool coplanar_segment_meets_triangle(const glm::dvec3& p, const glm::dvec3& q, const Triangle& t) {
    return segment_meets_triangle_2d(p, q, t, 0, 1) && segment_meets_triangle_2d(p, q, t, 1, 2) &&
           segment_meets_triangle_2d(p, q, t, 2, 0);
}

bool is_degenerate(const Triangle& t) {
    return orientation_2d(t[0], t[1], t[2], 0, 1) == 0 && orientation_2d(t[0], t[1], t[2], 1, 2) == 0 &&
           orientation_2d(t[0], t[1], t[2], 2, 0) == 0;
}

}  // namespace

bool segment_meets_triangle(const glm::dvec3& p, const glm::dvec3& q, const Triangle& t) {
    if (is_degenerate(t)) {
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 &a = t[k], &b = t[(k + 1) % 3];
            if (orientation(p, q, a, b) == 0 && segments_meet_2d(p, q, a, b, 0, 1) &&
                segments_meet_2d(p, q, a, b, 1, 2) && segments_meet_2d(p, q, a, b, 2, 0))
                return true;
        }
        return false;
    }
    const int side_p = orientation(t[0], t[1], t[2], p), side_q = orientation(t[0], t[1], t[2], q);
    if (side_p * side_q > 0) return false;
    if (side_p == 0 && side_q == 0) return coplanar_segment_meets_triangle(p, q, t);
    int low = 1, high = -1;
    for (std::size_t k = 0; k < 3; ++k) {
        const int turn = orientation(p, q, t[k], t[(k + 1) % 3]);
        low = std::min(low, turn);
        high = std::max(high, turn);
    }
    return low >= 0 || high <= 0;
}

namespace {

// The intersection is convex; unless it is empty, an edge of one triangle reaches into the other.
bool intersects_exactly(const Triangle& a, const Triangle& b) {
    for (std::size_t k = 0; k < 3; ++k)
        if (segment_meets_triangle(a[k], a[(k + 1) % 3], b) || segment_meets_triangle(b[k], b[(k + 1) % 3], a))
            return true;
    return false;
}

// Turns t so that t[0] is the vertex alone on its side of the other's plane; sides are all nonzero and not all equal.
int turn_to_lone_vertex(Triangle& t, const std::array<int, 3>& side) {
    const std::size_t lone = side[1] == side[2] ? 0 : (side[0] == side[2] ? 1 : 2);
    std::rotate(t.begin(), t.begin() + static_cast<std::ptrdiff_t>(lone), t.end());
    return side[lone];
}

using Sides = std::array<int, 3>;

Sides sides_of(const Triangle& plane, const Triangle& t) {
    const PlaneFilter filter(plane);
    return {filter.side(t[0]), filter.side(t[1]), filter.side(t[2])};
}

bool is_certain(const Sides& s) {
    return s[0] != kUnknownSign && s[1] != kUnknownSign && s[2] != kUnknownSign;
}

}  // namespace

// Guigue and Devillers, "Fast and robust triangle-triangle overlap test using orientation predicates", 2003: valid when
// no sign is zero; all else goes the slow way.
bool intersects(const Triangle& a, const Triangle& b) {
    const glm::dvec3 sum = a[0] + a[1] + a[2] + b[0] + b[1] + b[2];
    if (!(std::abs(sum.x) + std::abs(sum.y) + std::abs(sum.z) < std::numeric_limits<double>::infinity())) return false;
    for (int i = 0; i < 3; ++i)
        if (std::max({a[0][i], a[1][i], a[2][i]}) < std::min({b[0][i], b[1][i], b[2][i]}) ||
            std::max({b[0][i], b[1][i], b[2][i]}) < std::min({a[0][i], a[1][i], a[2][i]}))
            return false;
    const Sides side_b = sides_of(a, b);
    if (is_certain(side_b) && side_b[0] == side_b[1] && side_b[1] == side_b[2]) return false;
    const Sides side_a = sides_of(b, a);
    if (is_certain(side_a) && side_a[0] == side_a[1] && side_a[1] == side_a[2]) return false;
    if (!is_certain(side_a) || !is_certain(side_b)) return intersects_exactly(a, b);
    Triangle p = a, q = b;
    const int lone_a = turn_to_lone_vertex(p, side_a), lone_b = turn_to_lone_vertex(q, side_b);
    // The lone vertex of each is to lie above the other's plane: flip the other where it does not.
    if (lone_a > 0) std::swap(q[1], q[2]);
    if (lone_b > 0) std::swap(p[1], p[2]);
    const int first = PlaneFilter(p[1], q[0], p[0]).side(q[1]), second = PlaneFilter(p[0], q[0], p[2]).side(q[2]);
    if (first == kUnknownSign || second == kUnknownSign) return intersects_exactly(a, b);
    return first > 0 && second > 0;
}

}  // namespace crofton::mesh
