// SPDX-License-Identifier: MIT
// Simple bodies that boxes meet: spheres, capsules, triangles, half-spaces.
#pragma once
#include <crofton/geometry/obb.hpp>
#include <crofton/geometry/plane.hpp>
#include <crofton/geometry/sphere.hpp>
#include <crofton/mesh/triangle_triangle.hpp>
#include <glm/vec3.hpp>

namespace crofton::collide {

// All points within `radius` of the segment.
struct Capsule {
    glm::dvec3 begin{0.0}, end{0.0};
    double radius = 0.0;
};

// Touching counts, NaN meets nothing. Half-spaces { x : dot(normal, x) + offset ≥ 0 } and triangles: exact for the
// stored numbers, for every valid box and coordinates of 0 or magnitude in [1e-70, 1e30]. Spheres and capsules: a gap
// or overlap below 1e-13 of the coordinates' size may be told either way.
[[nodiscard]] bool intersects(const Obb& box, const Plane& half_space);
[[nodiscard]] bool intersects(const Obb& box, const Triangle& triangle);
[[nodiscard]] bool intersects(const Obb& box, const Sphere& sphere);
[[nodiscard]] bool intersects(const Obb& box, const Capsule& capsule);

// A convex body as the distance and contact queries see it: the hull of at most eight points, grown by a radius; with
// the directions of its edges and the normals of its faces.
struct ConvexShape {
    glm::dvec3 points[8];
    int point_count = 0;
    glm::dvec3 edges[3];
    int edge_count = 0;
    glm::dvec3 normals[3];  // unit, or zero where degenerate
    int normal_count = 0;
    double radius = 0.0;
};
[[nodiscard]] ConvexShape to_convex_shape(const Obb& box);
[[nodiscard]] ConvexShape to_convex_shape(const Sphere& sphere);
[[nodiscard]] ConvexShape to_convex_shape(const Capsule& capsule);
[[nodiscard]] ConvexShape to_convex_shape(const Triangle& triangle);

}  // namespace crofton::collide
