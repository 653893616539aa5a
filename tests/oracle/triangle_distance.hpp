// SPDX-License-Identifier: MIT
// Oracle: the distance of two triangles, in double, by trying all pairs of their features.
#pragma once
#include <algorithm>
#include <cmath>
#include <crofton/geometry/shapes.hpp>
#include <glm/geometric.hpp>
#include <oracle/impacts.hpp>

namespace crofton::oracle {

// From an end of one, or between points inside both: there the way is across both.
inline double distance_of_segments(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
    double least = std::min({distance_to_segment(a, c, d), distance_to_segment(b, c, d), distance_to_segment(c, a, b),
                             distance_to_segment(d, a, b)});
    const glm::dvec3 u = b - a, v = d - c, w = a - c, n = glm::cross(u, v);
    const double n2 = glm::dot(n, n);
    if (n2 < 1e-24 * glm::dot(u, u) * glm::dot(v, v)) return least;
    const double s = glm::dot(glm::cross(v, w), n) / n2, t = glm::dot(glm::cross(u, w), n) / n2;
    if (s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0) least = std::min(least, glm::length(w + s * u - t * v));
    return least;
}

// Tests whether a segment passes through a triangle, in double.
inline bool pierces(const glm::dvec3& from, const glm::dvec3& to, const Triangle& t) {
    const glm::dvec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
    const double at_from = glm::dot(n, from - t[0]), at_to = glm::dot(n, to - t[0]);
    if (glm::dot(n, n) == 0.0 || at_from * at_to > 0.0 || at_from == at_to) return false;
    const glm::dvec3 p = from + at_from / (at_from - at_to) * (to - from);
    for (std::size_t k = 0; k < 3; ++k)
        if (glm::dot(glm::cross(t[(k + 1) % 3] - t[k], p - t[k]), n) < 0.0) return false;
    return true;
}

// Tries all pairs of vertices, edges and faces.
inline double distance_of_triangles(const Triangle& a, const Triangle& b) {
    double least = HUGE_VAL;
    for (std::size_t i = 0; i < 3; ++i) {
        if (pierces(a[i], a[(i + 1) % 3], b) || pierces(b[i], b[(i + 1) % 3], a)) return 0.0;
        least = std::min(
            {least, distance_to_triangle(a[i], b[0], b[1], b[2]), distance_to_triangle(b[i], a[0], a[1], a[2])});
        for (std::size_t j = 0; j < 3; ++j)
            least = std::min(least, distance_of_segments(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]));
    }
    return least;
}

}  // namespace crofton::oracle
