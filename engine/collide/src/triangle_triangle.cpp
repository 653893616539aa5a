#include <algorithm>
#include <cmath>
#include <crofton/collide/triangle_triangle.hpp>
#include <crofton/geometry/expansion.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "sign_filter.hpp"

namespace crofton::collide {
namespace {

using Exact3 = std::array<Expansion<2>, 3>;

Exact3 exact_offset(const glm::dvec3& a, const glm::dvec3& b) {
    return {exact_difference(b.x, a.x), exact_difference(b.y, a.y), exact_difference(b.z, a.z)};
}

int exact_orientation(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
    const Exact3 u = exact_offset(a, b), v = exact_offset(a, c), w = exact_offset(a, d);
    const auto term = [&](std::size_t i, std::size_t j, std::size_t k) { return (u[i] * v[j] - u[j] * v[i]) * w[k]; };
    return (term(1, 2, 0) + term(2, 0, 1) + term(0, 1, 2)).sign();
}

// The same in the plane of coordinates i and j.
int orientation_2d(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, int i, int j) {
    const double left = (b[i] - a[i]) * (c[j] - a[j]), right = (b[j] - a[j]) * (c[i] - a[i]);
    // Shewchuk's bound ccwerrboundA, (3 + 16u)u, rounded up; as there, products that underflow are left to the caller's
    // range.
    const double error = 0x1.9p-52 * (std::abs(left) + std::abs(right));
    const double difference = left - right;
    if (difference > error) return 1;
    if (difference < -error) return -1;
    const auto exact_left = exact_difference(b[i], a[i]) * exact_difference(c[j], a[j]);
    const auto exact_right = exact_difference(b[j], a[j]) * exact_difference(c[i], a[i]);
    return (exact_left - exact_right).sign();
}

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

// All on one plane: they meet iff their projections to all three coordinate planes do, for one of these is one-to-one
// on the common plane and the others only lose distinctions.
bool coplanar_segment_meets_triangle(const glm::dvec3& p, const glm::dvec3& q, const Triangle& t) {
    return segment_meets_triangle_2d(p, q, t, 0, 1) && segment_meets_triangle_2d(p, q, t, 1, 2) &&
           segment_meets_triangle_2d(p, q, t, 2, 0);
}

bool is_degenerate(const Triangle& t) {
    return orientation_2d(t[0], t[1], t[2], 0, 1) == 0 && orientation_2d(t[0], t[1], t[2], 1, 2) == 0 &&
           orientation_2d(t[0], t[1], t[2], 2, 0) == 0;
}

bool segment_meets_triangle(const glm::dvec3& p, const glm::dvec3& q, const Triangle& t) {
    if (is_degenerate(t)) {
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 &a = t[k], &b = t[(k + 1) % 3];
            if (orientation_sign(p, q, a, b) == 0 && segments_meet_2d(p, q, a, b, 0, 1) &&
                segments_meet_2d(p, q, a, b, 1, 2) && segments_meet_2d(p, q, a, b, 2, 0))
                return true;
        }
        return false;
    }
    const int side_p = orientation_sign(t[0], t[1], t[2], p), side_q = orientation_sign(t[0], t[1], t[2], q);
    if (side_p * side_q > 0) return false;
    if (side_p == 0 && side_q == 0) return coplanar_segment_meets_triangle(p, q, t);
    int low = 1, high = -1;
    for (std::size_t k = 0; k < 3; ++k) {
        const int turn = orientation_sign(p, q, t[k], t[(k + 1) % 3]);
        low = std::min(low, turn);
        high = std::max(high, turn);
    }
    return low >= 0 || high <= 0;
}

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

int orientation_sign(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
    const int sign = orientation_filter(a, b, c, d);
    return sign == kUnknownSign ? exact_orientation(a, b, c, d) : sign;
}

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
    if (lone_a < 0) std::swap(q[1], q[2]);
    if (lone_b < 0) std::swap(p[1], p[2]);
    const int first = orientation_filter(p[1], q[0], p[0], q[1]), second = orientation_filter(p[0], q[0], p[2], q[2]);
    if (first == kUnknownSign || second == kUnknownSign) return intersects_exactly(a, b);
    return first < 0 && second < 0;
}

namespace {

// The part of a segment that is left after clipping, as parameters.
struct Interval {
    double low = 0.0, high = 1.0;
};

bool clip_to_plane_side(Interval& range, double at_begin, double at_end) {
    if (at_begin < 0.0 && at_end < 0.0) return false;
    if (at_begin < 0.0) range.low = std::max(range.low, at_begin / (at_begin - at_end));
    if (at_end < 0.0) range.high = std::min(range.high, at_begin / (at_begin - at_end));
    return range.low <= range.high;
}

void add_point(SegmentOfContact& best, int& count, const glm::dvec3& point) {
    if (count++ == 0) {
        best = {point, point};
        return;
    }
    const auto length2 = [](const glm::dvec3& v) { return glm::dot(v, v); };
    const double now = length2(best.end - best.begin);
    const double from_begin = length2(point - best.begin), from_end = length2(point - best.end);
    if (from_begin >= from_end && from_begin > now)
        best.end = point;
    else if (from_end > now)
        best.begin = point;
}

// Points at which the edges of `t` cross the plane of `other` within it, or run in it.
void add_edge_points(const Triangle& t, const Triangle& other, SegmentOfContact& best, int& count) {
    const glm::dvec3 n = glm::cross(other[1] - other[0], other[2] - other[0]);
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 &p = t[k], &q = t[(k + 1) % 3];
        if (!segment_meets_triangle(p, q, other)) continue;
        const double at_p = glm::dot(n, p - other[0]), at_q = glm::dot(n, q - other[0]);
        const bool crosses = orientation_sign(other[0], other[1], other[2], p) != 0 ||
                             orientation_sign(other[0], other[1], other[2], q) != 0;
        if (crosses && at_p != at_q) {
            add_point(best, count, p + std::clamp(at_p / (at_p - at_q), 0.0, 1.0) * (q - p));
            continue;
        }
        Interval range;
        bool left = true;
        for (std::size_t e = 0; e < 3 && left; ++e) {
            const glm::dvec3 inward = glm::cross(n, other[(e + 1) % 3] - other[e]);
            left = clip_to_plane_side(range, glm::dot(inward, p - other[e]), glm::dot(inward, q - other[e]));
        }
        if (!left) range = {0.5, 0.5};  // touches by less than rounding tells
        add_point(best, count, p + range.low * (q - p));
        add_point(best, count, p + range.high * (q - p));
    }
}

}  // namespace

SegmentOfContact contact_segment(const Triangle& a, const Triangle& b) {
    SegmentOfContact best{a[0], a[0]};
    int count = 0;
    add_edge_points(a, b, best, count);
    add_edge_points(b, a, best, count);
    return best;
}

}  // namespace crofton::collide
