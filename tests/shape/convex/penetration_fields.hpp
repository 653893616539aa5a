// SPDX-License-Identifier: MIT
// Checks every field of a penetration by itself.
#pragma once
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/convex/query.hpp>

#include "random_shapes.hpp"

namespace crofton::testing {

// How far the shape reaches along a unit vector, in the world.
inline double reach_along(const convex::ShapeAtPose& shape, const glm::dvec3& n) {
    const glm::dvec3 local = glm::transpose(shape.pose.rotation) * n;
    // A rounding is of the world: the support of the core, and the radius.
    const double radius = shape.shape.radius();
    const glm::dvec3 core = support_point(shape.shape, local) - radius / glm::length(local) * local;
    return glm::dot(n, shape.pose.rotation * core + shape.pose.translation) + radius;
}

// The way ends the overlap, none along other directions that is shorter does, and the points are the deepest ones, on
// both. `size` is that of the pair, `slack` what may be off.
inline void check_penetration_fields(const convex::ShapeAtPose& a, const convex::ShapeAtPose& b,
                                     const convex::Penetration& p, double slack, double size, RandomShapes& random) {
    // Points and extents in the world are rounded to its coordinates.
    const double rounding = 1e-15 * glm::length(a.pose.translation), place = slack + rounding;
    CHECK(p.overlapping);
    CHECK(p.lower <= p.depth);
    CHECK(p.depth <= p.upper);
    CHECK(p.upper - p.lower <= slack);
    CHECK(glm::length(p.normal) == doctest::Approx(1.0).epsilon(1e-12));
    CHECK(glm::distance(p.on_a - p.on_b, p.depth * p.normal) <= 1e-12 * size + rounding);
    CHECK(std::abs(reach_along(a, p.normal) - glm::dot(p.normal, p.on_a)) <= place);
    CHECK(std::abs(reach_along(b, -p.normal) + glm::dot(p.normal, p.on_b)) <= place);
    CHECK(closest_point(a, p.on_a).distance <= place);
    CHECK(closest_point(b, p.on_b).distance <= place);
    CHECK(std::abs(reach_along(a, p.normal) + reach_along(b, -p.normal) - p.depth) <= place);
    for (int k = 0; k < 20; ++k) {
        const glm::dvec3 d = glm::normalize(p.normal + std::pow(10.0, -0.5 * k) * random.direction());
        CHECK(reach_along(a, d) + reach_along(b, -d) >= p.lower - 1e-12 * size - rounding);
    }
}

}  // namespace crofton::testing
