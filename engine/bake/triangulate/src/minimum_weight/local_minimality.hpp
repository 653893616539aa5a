// SPDX-License-Identifier: MIT
// Whether an edge is the better diagonal of its two triangles.
#pragma once
#include <cmath>
#include <crofton/geometry/predicates.hpp>
#include <glm/vec2.hpp>
#include <span>

#include "domain/half_edge_mesh.hpp"

namespace crofton::triangulate {

// As shorter(), where rounded lengths cannot decide.
[[nodiscard]] bool shorter_exactly(std::span<const glm::dvec2> points, Index a, Index b, Index p, Index q);

// Whether edge ab comes before pq: the shorter one does, exactly; of equal ones that with the smaller pair of vertices.
[[nodiscard]] inline bool shorter(std::span<const glm::dvec2> points, Index a, Index b, Index p, Index q) {
    const glm::dvec2 d = points[a] - points[b], e = points[p] - points[q];
    const double dd = d.x * d.x + d.y * d.y, ee = e.x * e.x + e.y * e.y;
    // Each squared length errs by less than 4 units of 2^-53.
    if (std::fabs(dd - ee) > (dd + ee) * 0x1p-50) return dd < ee;
    return shorter_exactly(points, a, b, p, q);
}

// Whether flipping pq between triangles with apexes left and right of it would not improve on it. The flip is longer,
// or impossible as the two form no strictly convex quadrilateral.
[[nodiscard]] inline bool locally_minimal(std::span<const glm::dvec2> points, Index p, Index q, Index left,
                                          Index right) {
    return !shorter(points, left, right, p, q) || orientation(points[right], points[left], points[p]) <= 0 ||
           orientation(points[right], points[left], points[q]) >= 0;
}

// Whether two candidates cross. They contain no vertex inside, so unless they share an end all sides are strict.
[[nodiscard]] bool candidates_cross(std::span<const glm::dvec2> points, Index a, Index b, Index c, Index d);

}  // namespace crofton::triangulate
