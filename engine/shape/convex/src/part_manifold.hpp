// SPDX-License-Identifier: MIT
// Manifolds of shapes of parts.
#pragma once
#include "part_query.hpp"
#include "triangle_touch.hpp"

namespace crofton::convex {

// The manifold with the shapes seen in the other order.
[[nodiscard]] Manifold flipped(Manifold manifold);

// Of contact_manifolds: that with the deepest point.
[[nodiscard]] Manifold deepest_manifold(const ShapeAtPose& a, const ShapeAtPose& b, const ManifoldOptions& options);

// The middle of a convex shape, around an origin: the center of mass for hulls, else of its bounds.
[[nodiscard]] glm::dvec3 middle_of(const ShapeAtPose& shape, const glm::dvec3& origin);

// Whether the middle of the shape is on the front of the triangle's plane; half-spaces are. The triangle's corners and
// the middle are around the same origin.
[[nodiscard]] bool is_in_front(const PlacedTriangle& triangle, const Shape& shape, const glm::dvec3& middle);

}  // namespace crofton::convex
