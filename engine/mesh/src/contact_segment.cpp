// SPDX-License-Identifier: MIT
#include <algorithm>
#include <crofton/mesh/mesh_query.hpp>
#include <glm/geometric.hpp>

#include "contact_segment.hpp"
#include "exact_signs.hpp"

namespace crofton::mesh {
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

// Where the segment from p to q crosses a plane, by its ends' heights above it.
glm::dvec3 crossing(const glm::dvec3& p, const glm::dvec3& q, double at_p, double at_q) {
    return p + std::clamp(at_p / (at_p - at_q), 0.0, 1.0) * (q - p);
}

// Points at which the edges of `t` cross the plane of `other` within it, or run in it.
void add_edge_points(const Triangle& t, const Triangle& other, SegmentOfContact& best, int& count) {
    const glm::dvec3 n = scaled_normal(other);
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 &p = t[k], &q = t[(k + 1) % 3];
        if (!segment_meets_triangle(p, q, other)) continue;
        const double at_p = glm::dot(n, p - other[0]), at_q = glm::dot(n, q - other[0]);
        const bool crosses =
            orientation(other[0], other[1], other[2], p) != 0 || orientation(other[0], other[1], other[2], q) != 0;
        if (crosses && at_p != at_q) {
            add_point(best, count, crossing(p, q, at_p, at_q));
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

SegmentOfContact contact_segment(const Triangle& a, const Triangle& b, std::uint32_t edges) {
    if (edges == 0) return contact_segment(a, b);
    SegmentOfContact best{a[0], a[0]};
    int count = 0;
    for (int side = 0; side < 2; ++side) {
        const Triangle &t = side == 0 ? a : b, &other = side == 0 ? b : a;
        const std::uint32_t crossed = edges >> (3 * side) & 7u;
        if (crossed == 0) continue;
        const glm::dvec3 n = scaled_normal(other);
        for (std::size_t k = 0; k < 3; ++k) {
            if ((crossed >> k & 1u) == 0) continue;
            const glm::dvec3 &p = t[k], &q = t[(k + 1) % 3];
            add_point(best, count, crossing(p, q, glm::dot(n, p - other[0]), glm::dot(n, q - other[0])));
        }
    }
    return best;
}

}  // namespace crofton::mesh
