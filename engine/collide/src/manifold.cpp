#include <algorithm>
#include <cmath>
#include <crofton/collide/convex_query.hpp>
#include <crofton/collide/obb_obb.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include <crofton/geometry/closest_points.hpp>

namespace crofton::collide {
namespace {

// Corners of the face of a box whose outward normal is sign · axis k, in order around it.
struct Face {
    glm::dvec3 corner[4];
    glm::dvec3 normal;  // outward, unit
};

Face face_of(const Obb& box, const Convex& body, int k, double sign) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const auto edge = [&](int e) { return glm::dvec3(box.axes[e]) * static_cast<double>(box.half_extents[e]); };
    const glm::dvec3 middle = box.center + sign * edge(k), u = edge(i), v = edge(j);
    Face face{{middle - u - v, middle + u - v, middle + u + v, middle - u + v}, body.normals[k]};
    if (glm::dot(face.normal, sign * glm::dvec3(box.axes[k])) < 0.0) face.normal = -face.normal;
    return face;
}

// The face that looks most nearly along `direction`.
Face face_toward(const Obb& box, const Convex& body, const glm::dvec3& direction, double& alignment) {
    int best = 0;
    alignment = -1.0;
    for (int k = 0; k < 3; ++k) {
        const double along = std::abs(glm::dot(body.normals[k], direction));
        if (along > alignment + 1e-9) alignment = along, best = k;  // the first of equals, on every machine
    }
    const double sign = glm::dot(glm::dvec3(box.axes[best]), direction) >= 0.0 ? 1.0 : -1.0;
    return face_of(box, body, best, sign);
}

struct Polygon8 {
    glm::dvec3 point[8];
    int count = 0;
};

// The part of a convex polygon with dot(normal, x) ≤ offset (Sutherland and Hodgman): a convex polygon gains at most
// one corner from each of the four sides it is clipped by.
Polygon8 clip(const Polygon8& polygon, const glm::dvec3& normal, double offset) {
    Polygon8 result;
    for (int i = 0; i < polygon.count; ++i) {
        const glm::dvec3 &p = polygon.point[i], &q = polygon.point[(i + 1) % polygon.count];
        const double at_p = glm::dot(normal, p) - offset, at_q = glm::dot(normal, q) - offset;
        if (at_p <= 0.0 && result.count < 8) result.point[result.count++] = p;
        if (((at_p < 0.0 && at_q > 0.0) || (at_p > 0.0 && at_q < 0.0)) && result.count < 8)
            result.point[result.count++] = p + at_p / (at_p - at_q) * (q - p);
    }
    return result;
}

// Points of `incident` below `reference`, within its sides.
void clip_faces(const Face& reference, const Face& incident, Manifold& manifold) {
    Polygon8 polygon;
    for (const glm::dvec3& corner : incident.corner) polygon.point[polygon.count++] = corner;
    glm::dvec3 middle(0.0);
    for (const glm::dvec3& corner : reference.corner) middle += 0.25 * corner;
    for (int e = 0; e < 4 && polygon.count > 0; ++e) {
        const glm::dvec3 &p = reference.corner[e], &q = reference.corner[(e + 1) % 4];
        glm::dvec3 outward = glm::cross(q - p, reference.normal);
        if (outward == glm::dvec3(0.0)) continue;  // a side without length bounds nothing
        if (glm::dot(outward, middle - p) > 0.0) outward = -outward;
        polygon = clip(polygon, outward, glm::dot(outward, p));
    }
    for (int i = 0; i < polygon.count; ++i) {
        const double depth = glm::dot(reference.normal, reference.corner[0] - polygon.point[i]);
        if (depth < 0.0) continue;
        bool known = false;
        for (int j = 0; j < manifold.count; ++j) {
            const glm::dvec3 apart = manifold.points[j].position - (polygon.point[i] + 0.5 * depth * reference.normal);
            known = known || glm::dot(apart, apart) == 0.0;
        }
        if (!known) manifold.points[manifold.count++] = {polygon.point[i] + 0.5 * depth * reference.normal, depth};
    }
}

// The middle of the nearest points of the two edges that face each other along the axis.
ContactPoint edge_contact(const Obb& a, const Obb& b, const Penetration& deepest) {
    const auto edge_toward = [](const Obb& box, const glm::dvec3& direction, glm::dvec3& p, glm::dvec3& q) {
        glm::dvec3 middle = box.center, along(0.0);
        double least = std::numeric_limits<double>::infinity();
        for (int k = 0; k < 3; ++k)
            if (const double slope = std::abs(glm::dot(glm::dvec3(box.axes[k]), direction)); slope < least)
                least = slope;
        bool taken = false;
        for (int k = 0; k < 3; ++k) {
            const glm::dvec3 axis(box.axes[k]), edge = axis * static_cast<double>(box.half_extents[k]);
            const double slope = glm::dot(axis, direction);
            if (!taken && std::abs(slope) == least) {
                along = edge;
                taken = true;
            } else {
                middle += slope >= 0.0 ? edge : -edge;
            }
        }
        p = middle - along;
        q = middle + along;
    };
    glm::dvec3 pa, qa, pb, qb;
    edge_toward(a, deepest.axis, pa, qa);
    edge_toward(b, -deepest.axis, pb, qb);
    ClosestPoints nearest;
    closest_of_segments(pa, qa, pb, qb, nearest);
    return {0.5 * (nearest.on_a + nearest.on_b), std::max(0.0, deepest.depth)};
}

}  // namespace

Manifold contact_manifold(const Obb& a, const Obb& b) {
    Manifold manifold;
    if (!intersects(a, b)) return manifold;
    const Convex body_a = convex(a), body_b = convex(b);
    const Penetration deepest = penetration(body_a, body_b);
    manifold.normal = deepest.axis;
    manifold.depth = std::max(0.0, deepest.depth);
    double along_a = 0.0, along_b = 0.0;
    const Face face_a = face_toward(a, body_a, deepest.axis, along_a),
               face_b = face_toward(b, body_b, -deepest.axis, along_b);
    // Faces touch where the axis is a face's normal; edges where it is neither's.
    constexpr double kFaceAlignment = 0.9999;
    if (std::max(along_a, along_b) >= kFaceAlignment) {
        if (along_a + 1e-6 >= along_b)
            clip_faces(face_a, face_b, manifold);
        else
            clip_faces(face_b, face_a, manifold);
    }
    if (manifold.count == 0) manifold.points[manifold.count++] = edge_contact(a, b, deepest);
    return manifold;
}

Manifold contact_manifold(const Convex& a, const Convex& b) {
    Manifold manifold;
    const Penetration deepest = penetration(a, b);
    if (deepest.depth < 0.0) return manifold;
    manifold.normal = deepest.axis;
    manifold.depth = deepest.depth;
    // Parted along the axis they touch in one place: the nearest points then, moved back by half the depth.
    Convex parted = b;
    const double gap = deepest.depth + a.radius + b.radius + 1.0;
    for (int i = 0; i < parted.point_count; ++i) parted.points[i] += gap * deepest.axis;
    Convex core_a = a;
    core_a.radius = parted.radius = 0.0;
    const Distance apart = distance(core_a, parted);
    const glm::dvec3 on_a = apart.on_a + a.radius * deepest.axis;
    manifold.points[manifold.count++] = {on_a - 0.5 * deepest.depth * deepest.axis, deepest.depth};
    return manifold;
}

Manifold contact_manifold(const Plane& half_space, const Obb& box) {
    Manifold manifold;
    const Convex body = convex(box);
    const Penetration deepest = penetration(half_space, body);
    if (!intersects(box, half_space)) return manifold;
    manifold.normal = deepest.axis;
    manifold.depth = std::max(0.0, deepest.depth);
    const double length = glm::length(half_space.normal);
    for (int i = 0; i < body.point_count; ++i) {
        const double depth = (glm::dot(half_space.normal, body.points[i]) + half_space.offset) / length;
        if (depth >= 0.0) manifold.points[manifold.count++] = {body.points[i] + 0.5 * depth * deepest.axis, depth};
    }
    if (manifold.count == 0) {
        const glm::dvec3 lowest = support_point(box, half_space.normal);
        manifold.points[manifold.count++] = {lowest, 0.0};
    }
    return manifold;
}

}  // namespace crofton::collide
