// SPDX-License-Identifier: MIT
// Closest points of simple features, in double. Candidates are points of the features themselves, so a distance may be
// too large by rounding but never stands for a point outside.
#pragma once
#include <algorithm>
#include <crofton/geometry/shapes.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace crofton {

struct ClosestPoints {
    double squared = std::numeric_limits<double>::infinity();
    glm::dvec3 on_a{0.0}, on_b{0.0};

    void offer(const glm::dvec3& a, const glm::dvec3& b) {
        const glm::dvec3 d = b - a;
        const double now = glm::dot(d, d);
        if (now < squared) *this = {now, a, b};
    }
};

[[nodiscard]] inline glm::dvec3 closest_on_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 along = b - a;
    const double length2 = glm::dot(along, along);
    if (!(length2 > 0.0)) return a;
    return a + std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) * along;
}

// Ends against the other segment, then the common perpendicular where it meets both. For lines at a small angle θ the
// cross product errs by 2^-52/θ of itself, and so does the place along the lines. That moves the distance by 2^-52 of
// their size. The determinant of dot products would err by 2^-52/θ².
inline void closest_of_segments(const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& a, const glm::dvec3& b,
                                ClosestPoints& best) {
    best.offer(p, closest_on_segment(p, a, b));
    best.offer(q, closest_on_segment(q, a, b));
    best.offer(closest_on_segment(a, p, q), a);
    best.offer(closest_on_segment(b, p, q), b);
    const glm::dvec3 u = q - p, v = b - a, n = glm::cross(u, v);
    const double determinant = glm::dot(n, n), s = glm::dot(glm::cross(a - p, v), n);
    if (!(s > 0.0 && s < determinant)) return;
    const glm::dvec3 on_first = p + s / determinant * u;
    best.offer(on_first, closest_on_segment(on_first, a, b));
}

// The foot of p's perpendicular on the triangle, where it falls inside. The normal of a sliver whose sides meet at a
// small angle θ errs by 2^-52/θ of itself. Its part along a side is removed, because it would tilt the plane over
// the whole length. Across, the sliver is only θ times as wide.
inline bool foot_inside(const glm::dvec3& p, const Triangle& t, glm::dvec3& foot) {
    const glm::dvec3 side = t[1] - t[0], across = glm::cross(side, t[2] - t[0]);
    const double side2 = glm::dot(side, side);
    const glm::dvec3 n = across - (side2 > 0.0 ? glm::dot(across, side) / side2 : 0.0) * side;
    const double length2 = glm::dot(n, n);
    if (!(length2 > 0.0)) return false;
    for (std::size_t k = 0; k < 3; ++k)
        if (glm::dot(glm::cross(n, t[(k + 1) % 3] - t[k]), p - t[k]) < 0.0) return false;
    foot = p - glm::dot(n, p - t[0]) / length2 * n;
    return true;
}

[[nodiscard]] inline glm::dvec3 closest_on_triangle(const glm::dvec3& p, const Triangle& t) {
    glm::dvec3 foot;
    if (foot_inside(p, t, foot)) return foot;
    ClosestPoints best;
    for (std::size_t k = 0; k < 3; ++k) best.offer(p, closest_on_segment(p, t[k], t[(k + 1) % 3]));
    return best.on_b;
}

// For triangles that do not meet.
inline void closest_of_triangles(const Triangle& a, const Triangle& b, ClosestPoints& best) {
    glm::dvec3 foot;
    for (std::size_t i = 0; i < 3; ++i) {
        if (foot_inside(a[i], b, foot)) best.offer(a[i], foot);
        if (foot_inside(b[i], a, foot)) best.offer(foot, b[i]);
        for (std::size_t j = 0; j < 3; ++j) closest_of_segments(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3], best);
    }
}

}  // namespace crofton
