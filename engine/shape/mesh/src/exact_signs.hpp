// SPDX-License-Identifier: MIT
// Exact signs of determinants of points, shared by the triangle tests.
#pragma once
#include <crofton/geometry/predicates.hpp>
#include <crofton/geometry/shapes.hpp>
#include <glm/vec3.hpp>

namespace crofton::mesh {

// The orientation of three points in the plane of coordinates i and j.
[[nodiscard]] inline int orientation_2d(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, int i, int j) {
    return orientation(glm::dvec2(a[i], a[j]), glm::dvec2(b[i], b[j]), glm::dvec2(c[i], c[j]));
}

// Exact for any segment, a point included, and any triangle, a segment or point included.
[[nodiscard]] bool segment_meets_triangle(const glm::dvec3& p, const glm::dvec3& q, const Triangle& t);

}  // namespace crofton::mesh
