// SPDX-License-Identifier: MIT
// Manifolds of bodies of parts.
#pragma once
#include "part_query.hpp"

namespace crofton::convex {

// The manifold with the bodies seen in the other order.
[[nodiscard]] Manifold flipped(Manifold manifold);

// The patches of two convex bodies across a given normal, clipped: only points that lie above each other.
[[nodiscard]] Manifold manifold_along(const Placed& a, const Placed& b, const glm::dvec3& normal,
                                      const ManifoldOptions& options);

// contact_manifold of two convex bodies; the cached face is kept within `kept` of the size.
[[nodiscard]] Manifold convex_manifold(const Placed& a, const Placed& b, const ManifoldOptions& options,
                                       PairCache* cache, double kept);

// The same where a is a triangle: its face is tried first.
[[nodiscard]] Manifold triangle_manifold(const Placed& a, const Placed& b, const ManifoldOptions& options);

// Of contact_manifolds: that with the deepest point.
[[nodiscard]] Manifold deepest_manifold(const Placed& a, const Placed& b, const ManifoldOptions& options);

// A surface's triangle in the world: its corners around an origin, its normal, zero where it has none.
struct PlacedTriangle {
    glm::dvec3 corner[3], normal;
};
[[nodiscard]] PlacedTriangle placed_triangle(const Part& part, const glm::dvec3& origin);

// The middle of a convex body, around an origin: the center of mass for hulls, else of its bounds.
[[nodiscard]] glm::dvec3 middle_of(const Placed& body, const glm::dvec3& origin);

// Whether the middle of the body is on the front of the triangle's plane.
[[nodiscard]] bool is_in_front(const Part& part, const Placed& body);

}  // namespace crofton::convex
