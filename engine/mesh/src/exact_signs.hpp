// Exact signs of determinants of points, shared by the triangle tests.
#pragma once
#include <crofton/mesh/triangle_triangle.hpp>
#include <glm/vec3.hpp>

namespace crofton::mesh {

// As orientation of three points in the plane of coordinates i and j: > 0 counter-clockwise, 0 collinear.
[[nodiscard]] int orientation_2d(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, int i, int j);

// Exact for any segment, a point included, and any triangle, a segment or point included.
[[nodiscard]] bool segment_meets_triangle(const glm::dvec3& p, const glm::dvec3& q, const Triangle& t);

}  // namespace crofton::mesh
