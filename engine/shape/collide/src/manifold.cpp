// SPDX-License-Identifier: MIT
// Contacts of bounds with spheres. Contact points of shapes are in convex/src/manifold.cpp.
#include <algorithm>
#include <cmath>
#include <crofton/collide/bound_contacts.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>

#include "manifold_points.hpp"

namespace crofton::collide {
namespace {

// `axis` points to the sphere, which lies `depth` ≥ 0 deep in the other shape.
Manifold touch_of_sphere(const Sphere& sphere, const glm::dvec3& axis, double depth) {
    Manifold manifold;
    manifold.normal = axis;
    manifold.depth = depth;
    manifold.points[manifold.count++] = {sphere.center - (sphere.radius - 0.5 * depth) * axis, depth};
    return manifold;
}

// The shortest way from a box's surface to a point: `gap` along `normal`, out of the box; negative within.
struct FaceGap {
    glm::dvec3 normal{0.0};
    double gap = 0.0;
};

// The way across a face, where that is the shortest; nothing where an edge or a corner is nearest or rounding decides.
// The box's center is the origin. Its axes are orthonormal to 1e-6 alone, so that normals are products of two. A
// coordinate along the axes is off by 20 roundings of 2^-53 of the size.
std::optional<FaceGap> gap_across_face(const Obb& box, const glm::dvec3& point) {
    glm::dvec3 axes[3], normal[3];
    double size = std::abs(point.x) + std::abs(point.y) + std::abs(point.z), half[3];
    for (int k = 0; k < 3; ++k) {
        axes[k] = glm::dvec3(box.axes[k]);
        half[k] = static_cast<double>(box.half_extents[k]);
        size += half[k];
    }
    for (int k = 0; k < 3; ++k) normal[k] = glm::cross(axes[(k + 1) % 3], axes[(k + 2) % 3]);
    const double determinant = glm::dot(axes[0], normal[0]), slack = 1e-13 * size;
    double beyond[3];  // of the faces, along the axes
    int face = -1, outside = 0;
    FaceGap nearest;
    for (int k = 0; k < 3; ++k) {
        const double along = glm::dot(normal[k], point), share = 1.0 / glm::length(normal[k]);
        beyond[k] = std::abs(along / determinant) - half[k];
        if (!(std::abs(beyond[k]) > slack)) return std::nullopt;
        outside += beyond[k] > 0.0 ? 1 : 0;
        const double gap = (std::abs(along) - std::abs(determinant) * half[k]) * share;
        if (face >= 0 && !(gap > nearest.gap)) continue;
        face = k;
        nearest = {(along < 0.0 ? -share : share) * normal[k], gap};
    }
    if (outside == 0) return nearest;
    if (outside > 1) return std::nullopt;
    // The foot of the perpendicular lies within the face?
    const glm::dvec3 foot = point - nearest.gap * nearest.normal;
    for (int k = 0; k < 3; ++k)
        if (k != face && !(std::abs(glm::dot(normal[k], foot) / determinant) < half[k] - slack)) return std::nullopt;
    return nearest;
}

}  // namespace

Manifold contact_manifold(const Obb& box, const Sphere& sphere) {
    if (!intersects(box, sphere)) return {};
    // Near the box's center, so that nothing is lost far from the origin.
    const Sphere near_sphere{sphere.center - box.center, sphere.radius};
    const Obb near_box{glm::dvec3(0.0), box.axes, box.half_extents};
    if (const auto face = gap_across_face(near_box, near_sphere.center))
        return touch_of_sphere(sphere, face->normal, std::max(0.0, sphere.radius - face->gap));
    const Distance center = distance(near_box, Capsule{near_sphere.center, near_sphere.center, 0.0});
    const glm::dvec3 way = center.on_b - center.on_a;
    const double length = glm::length(way);
    // Nearer than this the direction is rounding: the face across which it lies farthest out parts them as well.
    if (length > 1e-11 * glm::length(near_sphere.center))
        return touch_of_sphere(sphere, way / length, std::max(0.0, sphere.radius - length));
    const Penetration out = penetration(near_box, Obb{near_sphere.center, glm::mat3(1.0f), glm::vec3(0.0f)});
    return touch_of_sphere(sphere, out.axis, std::max(0.0, out.depth) + sphere.radius);
}

Manifold contact_manifold(const Sphere& a, const Sphere& b) {
    const glm::dvec3 way = b.center - a.center;
    const double length = glm::length(way), depth = a.radius + b.radius - length;
    if (!(depth >= 0.0)) return {};
    return touch_of_sphere(b, length > 0.0 ? way / length : glm::dvec3(0.0, 0.0, 1.0), depth);
}

}  // namespace crofton::collide
