// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/geometry/expansion.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <glm/geometric.hpp>

#include "contact_segment.hpp"
#include "exact_signs.hpp"
#include "exact_vectors.hpp"

namespace crofton::mesh {
namespace {

// The part of a segment that is left after clipping, as parameters.
struct Interval {
    double low = 0.0, high = 1.0;
};

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

double l1_norm(const glm::dvec3& v) {
    return std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
}

// A value at either end of a segment, linear in between.
struct Ends {
    double at_p, at_q;

    // Whether the place of the zero between them is known to 2^-34, if each errs by less than 2^-50 of `magnitude`.
    [[nodiscard]] bool tell(double magnitude) const { return std::abs(at_p - at_q) > 0x1p-16 * magnitude; }
    [[nodiscard]] double zero() const { return std::clamp(at_p / (at_p - at_q), 0.0, 1.0); }
};

// A triangle as seen from segments that meet it. Where a plane nearly holds the segment, heights over it in double are
// nothing but rounding: then they are computed exactly, and rounded once.
class TrianglePlane {
  public:
    explicit TrianglePlane(const Triangle& t)
        : t_(t), normal_(scaled_normal(t)), magnitude_(l1_norm(t[1] - t[0]) * l1_norm(t[2] - t[0])) {}

    // The heights of the ends above the plane, times the normal's length.
    [[nodiscard]] Ends heights(const glm::dvec3& p, const glm::dvec3& q) const {
        const Ends rounded{glm::dot(normal_, p - t_[0]), glm::dot(normal_, q - t_[0])};
        if (rounded.tell(magnitude_ * (l1_norm(p - t_[0]) + l1_norm(q - t_[0])))) return rounded;
        return exact_heights(p, q);
    }

    // What lies within the triangle of a segment that meets it and runs in its plane.
    [[nodiscard]] Interval part_within(const glm::dvec3& p, const glm::dvec3& q) const {
        const int dropped = largest_component();
        if (dropped < 0) return part_on_line(p, q);
        Interval range;
        for (std::size_t e = 0; e < 3; ++e) {
            const Ends inside = distances_inside(e, dropped, p, q);
            if (inside.at_p < 0.0 && inside.at_q >= 0.0) range.low = std::max(range.low, inside.zero());
            if (inside.at_q < 0.0 && inside.at_p >= 0.0) range.high = std::min(range.high, inside.zero());
        }
        if (range.low > range.high) range.low = range.high = 0.5 * (range.low + range.high);
        return range;
    }

  private:
    [[nodiscard]] Ends exact_heights(const glm::dvec3& p, const glm::dvec3& q) const;

    [[nodiscard]] std::array<Expansion<16>, 3> exact_normal() const {
        return cross(differences(t_[1], t_[0]), differences(t_[2], t_[0]));
    }

    // The largest axis of the exact normal, or −1 if the normal is zero.
    [[nodiscard]] int largest_component() const {
        const auto n = exact_normal();
        int largest = -1;
        double size = 0.0;
        for (int k = 0; k < 3; ++k)
            if (const double now = std::abs(n[static_cast<std::size_t>(k)].estimate()); now > size)
                size = now, largest = k;
        return largest;
    }

    // Twice the area of the triangle from a to b to x, seen along axis `dropped`.
    static double area_along(int dropped, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& x) {
        const int i = (dropped + 1) % 3, j = (dropped + 2) % 3;
        const auto ax = exact_difference(a[i], x[i]), ay = exact_difference(a[j], x[j]);
        const auto bx = exact_difference(b[i], x[i]), by = exact_difference(b[j], x[j]);
        return (ax * by - ay * bx).estimate();
    }

    // How far the ends lie inside of edge e's line, in some unit.
    [[nodiscard]] Ends distances_inside(std::size_t e, int dropped, const glm::dvec3& p, const glm::dvec3& q) const {
        const glm::dvec3 &from = t_[e], &to = t_[(e + 1) % 3];
        const glm::dvec3 inward = glm::cross(normal_, to - from);
        const Ends rounded{glm::dot(inward, p - from), glm::dot(inward, q - from)};
        const double magnitude = magnitude_ * l1_norm(to - from) * (l1_norm(p - from) + l1_norm(q - from));
        const double error = 0x1p-48 * magnitude;
        const bool certain = std::abs(rounded.at_p) > error && std::abs(rounded.at_q) > error;
        if (certain && (rounded.tell(magnitude) || (rounded.at_p > 0.0 && rounded.at_q > 0.0))) return rounded;
        const double turn = area_along(dropped, t_[0], t_[1], t_[2]);
        const double p_area = area_along(dropped, from, to, p), q_area = area_along(dropped, from, to, q);
        return turn > 0.0 ? Ends{p_area, q_area} : Ends{-p_area, -q_area};
    }

    // The same of a triangle that is a segment or a point.
    [[nodiscard]] Interval part_on_line(const glm::dvec3& p, const glm::dvec3& q) const {
        std::size_t longest = 0;
        for (std::size_t e = 1; e < 3; ++e)
            if (l1_norm(t_[(e + 1) % 3] - t_[e]) > l1_norm(t_[(longest + 1) % 3] - t_[longest])) longest = e;
        const glm::dvec3 &a = t_[longest], &b = t_[(longest + 1) % 3], along = q - p;
        Ends across{0.0, 0.0};
        for (int k = 0; k < 3; ++k) {
            const Ends seen{area_along(k, a, b, p), area_along(k, a, b, q)};
            if (std::abs(seen.at_p - seen.at_q) > std::abs(across.at_p - across.at_q)) across = seen;
        }
        if (across.at_p != across.at_q) return {across.zero(), across.zero()};
        const double length2 = glm::dot(along, along);
        if (!(length2 > 0.0)) return {0.0, 0.0};
        const double at_a = std::clamp(glm::dot(a - p, along) / length2, 0.0, 1.0);
        const double at_b = std::clamp(glm::dot(b - p, along) / length2, 0.0, 1.0);
        return {std::min(at_a, at_b), std::max(at_a, at_b)};
    }

    const Triangle& t_;
    glm::dvec3 normal_;
    double magnitude_;
};

// Apart from the class: rare, and far too large to be inlined.
Ends TrianglePlane::exact_heights(const glm::dvec3& p, const glm::dvec3& q) const {
    const auto n = exact_normal();
    const auto height = [&](const glm::dvec3& x) {
        const Differences d = differences(x, t_[0]);
        return (n[0] * d[0] + n[1] * d[1] + n[2] * d[2]).estimate();
    };
    return {height(p), height(q)};
}

// Points at which the edges of `t` cross the plane of `other` within it, or run in it.
void add_edge_points(const Triangle& t, const Triangle& other, SegmentOfContact& best, int& count) {
    const TrianglePlane plane(other);
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 &p = t[k], &q = t[(k + 1) % 3];
        if (!segment_meets_triangle(p, q, other)) continue;
        if (orientation(other[0], other[1], other[2], p) != 0 || orientation(other[0], other[1], other[2], q) != 0) {
            add_point(best, count, p + plane.heights(p, q).zero() * (q - p));
            continue;
        }
        const Interval range = plane.part_within(p, q);
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
        const TrianglePlane plane(other);
        for (std::size_t k = 0; k < 3; ++k) {
            if ((crossed >> k & 1u) == 0) continue;
            const glm::dvec3 &p = t[k], &q = t[(k + 1) % 3];
            add_point(best, count, p + plane.heights(p, q).zero() * (q - p));
        }
    }
    return best;
}

}  // namespace crofton::mesh
