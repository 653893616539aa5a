// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/collide/narrow_phase.hpp>
#include <glm/geometric.hpp>

#include "manifold_points.hpp"

namespace crofton::collide {
Manifold contact_manifold(const ConvexShape& a, const ConvexShape& b) {
    Manifold manifold;
    const Penetration deepest = penetration(a, b);
    if (deepest.depth < 0.0) return manifold;
    manifold.normal = deepest.axis;
    manifold.depth = deepest.depth;
    // One contact point: the bodies are moved apart along the axis, and the nearest points of both are taken. The point
    // lies between these, moved back by half the depth.
    ConvexShape parted = b;
    const double gap = deepest.depth + a.radius + b.radius + 1.0;
    for (int i = 0; i < parted.point_count; ++i) parted.points[i] += gap * deepest.axis;
    ConvexShape core_a = a;
    core_a.radius = parted.radius = 0.0;
    const Distance apart = distance(core_a, parted);
    const glm::dvec3 on_a = apart.on_a + a.radius * deepest.axis;
    manifold.points[manifold.count++] = {on_a - 0.5 * deepest.depth * deepest.axis, deepest.depth};
    return manifold;
}

Manifold contact_manifold(const Plane& half_space, const Obb& box, ManifoldPoints points) {
    Manifold manifold;
    const ConvexShape body = to_convex_shape(box);
    const Penetration deepest = penetration(half_space, body);
    if (!intersects(box, half_space)) return manifold;
    manifold.normal = deepest.axis;
    const double length = glm::length(half_space.normal);
    for (int i = 0; i < body.point_count; ++i) {
        const double depth = (glm::dot(half_space.normal, body.points[i]) + half_space.offset) / length;
        if (depth >= 0.0) manifold.points[manifold.count++] = {body.points[i] + 0.5 * depth * deepest.axis, depth};
    }
    if (manifold.count == 0) {
        const glm::dvec3 lowest = support_point(box, half_space.normal);
        manifold.points[manifold.count++] = {lowest, 0.0};
    }
    if (points == ManifoldPoints::reduced) reduce(manifold);
    set_depth(manifold);
    return manifold;
}

}  // namespace crofton::collide
