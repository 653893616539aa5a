// SPDX-License-Identifier: MIT
// Convex bodies in space, by their support function: the hull of points, grown by a radius. Spheres, boxes, frusta,
// flat polygons, segments and hulls have this form.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::study {

struct ConvexBody {
    Vector<glm::dvec3> points;  // at least one
    double radius = 0.0;

    [[nodiscard]] static ConvexBody sphere(const glm::dvec3& center, double radius) { return {{center}, radius}; }
    [[nodiscard]] static ConvexBody box(const Obb& box);
    // Errors: as validate(Camera); far must be finite.
    [[nodiscard]] static Result<ConvexBody> frustum(const Camera& camera);
};

// Returns h(n) = max over the body of dot(x, n), for n of any length.
[[nodiscard]] double support(const ConvexBody& body, const glm::dvec3& n);
// Returns a point of the body with that maximum; `n` is a unit vector.
[[nodiscard]] glm::dvec3 support_point(const ConvexBody& body, const glm::dvec3& n);
// Returns the distance of the two planes that are perpendicular to the unit vector n and touch the body.
[[nodiscard]] inline double breadth(const ConvexBody& body, const glm::dvec3& n) {
    return support(body, n) + support(body, -n);
}

}  // namespace crofton::study
