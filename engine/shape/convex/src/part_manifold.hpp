// SPDX-License-Identifier: MIT
// Manifolds of bodies of parts.
#pragma once
#include "part_query.hpp"
#include "triangle_touch.hpp"

namespace crofton::convex {

// The manifold with the bodies seen in the other order.
[[nodiscard]] Manifold flipped(Manifold manifold);

// Of contact_manifolds: that with the deepest point.
[[nodiscard]] Manifold deepest_manifold(const BodyAtPose& a, const BodyAtPose& b, const ManifoldOptions& options);

// The middle of a convex body, around an origin: the center of mass for hulls, else of its bounds.
[[nodiscard]] glm::dvec3 middle_of(const BodyAtPose& body, const glm::dvec3& origin);

// Whether the middle of the body is on the front of the triangle's plane; half-spaces are. The triangle's corners and
// the middle are around the same origin.
[[nodiscard]] bool is_in_front(const PlacedTriangle& triangle, const Body& body, const glm::dvec3& middle);

}  // namespace crofton::convex
