// SPDX-License-Identifier: MIT
#include "gather.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace crofton::convex {
namespace {

bool nearly_parallel(const Patch& a, const Patch& b) {
    const glm::dvec3 u = a.point[1] - a.point[0], v = b.point[1] - b.point[0], n = glm::cross(u, v);
    return glm::dot(n, n) <= 1e-3 * glm::dot(u, u) * glm::dot(v, v);
}

bool is_sharp(const Patch& segment) {
    const Shape& shape = segment.of->shape;
    return shape.radius() == 0.0 && (shape.has_polytope_core() || shape.half_extents().x == 0.0);
}

// A segment without width touches only what is opposite to it.
bool are_opposite(const Clipped& clipped, const glm::dvec3& normal, double length) {
    for (int i = 0; i < clipped.count; ++i) {
        const glm::dvec3 way = clipped.point[i].on_incident - clipped.point[i].on_reference;
        if (glm::length(way - glm::dot(way, normal) * normal) > 1e-9 * length) return false;
    }
    return true;
}

// Gathers the points of two sharp edges; gather_parallel_edges does round ones.
void gather_segments(const Patch& a, const Patch& b, const glm::dvec3& normal, Clipped& clipped, Gatherer& gatherer) {
    if (!is_sharp(a) || !is_sharp(b) || !nearly_parallel(a, b)) return;
    clip_segments(a, b, clipped);
    const double length = glm::length(a.point[1] - a.point[0]) + glm::length(b.point[1] - b.point[0]);
    if (are_opposite(clipped, normal, length)) gatherer.add(clipped, true);
}

// A last point takes the place of one with the same id.
void keep_ids_apart(GatheredPoints& points, int before) {
    if (points.count == before) return;
    for (int i = 0; i < before; ++i)
        if (has_same_id(points.point[i], points.point[before])) {
            points.point[i] = points.point[before];
            points.count = before;
            return;
        }
}

// Leaves a rounded box or capsule from within, along a unit vector; returns the way to the surface. The distance from
// the core is convex along the ray: Newton's method from beyond the surface comes back to it. Of a pose that is not
// quite orthonormal, which skews the core alone, the nearest point of the core is off by its skew, so the distance is
// by its square, below 1e-12.
double way_out(const glm::dvec3& half, double radius, const RigidTransform& pose, const glm::dvec3& point,
               const glm::dvec3& out) {
    constexpr double kBeyond = 1.0 + 1e-5;
    const glm::dmat3 to_local = glm::inverse(pose.rotation);
    const glm::dvec3 at = to_local * (point - pose.translation), along = to_local * out;
    double t = HUGE_VAL;
    for (int k = 0; k < 3; ++k)
        if (along[k] != 0.0)
            t = std::min(t, (half[k] + kBeyond * radius - std::copysign(1.0, along[k]) * at[k]) / std::abs(along[k]));
    for (int i = 0; i < 40; ++i) {
        const glm::dvec3 p = at + t * along, from_core = pose.rotation * (p - (glm::clamp)(p, -half, half));
        const double distance = glm::length(from_core), slope = glm::dot(from_core, out);
        if (!(slope > 0.0)) return 0.0;  // the ray passes the shape
        const double next = t - (distance - radius) * distance / slope;
        if (!(next < t)) break;
        t = next;
    }
    return std::max(t, 0.0);
}

// How far a point is below the surface of a rounded shape, along a direction out of it; 0 of one that is not inside.
double below_surface(const ShapeAtPose& placed, const glm::dvec3& point, const glm::dvec3& out) {
    const Shape& shape = placed.shape;
    if (shape.kind() == Kind::box || shape.kind() == Kind::capsule) {
        const glm::dvec3 half =
            shape.kind() == Kind::box ? glm::dvec3(shape.half_extents()) : glm::abs(glm::dvec3(shape.vertex(0)));
        return way_out(half, shape.radius(), placed.pose, point, out);
    }
    const double reach = shape.core_radius() + shape.radius(),
                 way = 2.0 * reach + glm::distance(point, placed.pose.translation);
    const auto hit = raycast(placed, {point + way * out, -out, way});
    return hit && !hit->started_inside ? way - hit->t : 0.0;
}

}  // namespace

void move_to_surface(const ShapeAtPose& a, const ShapeAtPose& b, const glm::dvec3& normal, double deepest,
                     std::span<ContactPoint> points) {
    if (a.shape.radius() == 0.0 && b.shape.radius() == 0.0) return;
    for (ContactPoint& p : points) {
        if (!(p.depth < deepest - 1e-9 * (a.shape.radius() + b.shape.radius()))) continue;
        const glm::dvec3 half = 0.5 * p.depth * normal;
        double up = a.shape.radius() > 0.0 ? below_surface(a, p.position + half, normal) : 0.0,
               down = b.shape.radius() > 0.0 ? below_surface(b, p.position - half, -normal) : 0.0;
        const double share = std::min(1.0, (deepest - p.depth) / std::max(up + down, 0x1p-1000));
        up *= share;
        down *= share;
        p.depth += up + down;
        p.position += 0.5 * (up - down) * normal;
    }
}

void Gatherer::add(const glm::dvec3& core_a, const glm::dvec3& core_b, const Feature& on_a, const Feature& on_b) {
    const glm::dvec3 p = core_a + of_.radius_a * touch_.normal, q = core_b - of_.radius_b * touch_.normal;
    // A face that is not quite flat would seem deeper than the shapes overlap.
    const double depth = std::min(glm::dot(p - q, touch_.normal), touch_.depth);
    if (!(depth >= -of_.margin)) return;
    points.point[points.count++] = {of_.origin + 0.5 * (p + q), depth, on_a, on_b, {}, {}};
}

void Gatherer::add(const Clipped& clipped, bool reference_is_a) {
    for (int i = 0; i < clipped.count; ++i) {
        const ClippedPoint& c = clipped.point[i];
        if (reference_is_a)
            add(c.on_reference, c.on_incident, c.reference, c.incident);
        else
            add(c.on_incident, c.on_reference, c.incident, c.reference);
    }
}

bool Gatherer::lacks_deepest(double tolerance) const {
    for (int i = 0; i < points.count; ++i)
        if (points.point[i].depth >= touch_.depth - tolerance) return false;
    return true;
}

ContactPoint deepest_point(const Gathering& of, const Touch& touch) {
    const glm::dvec3 p = touch.on_a + of.radius_a * touch.normal, q = touch.on_b - of.radius_b * touch.normal;
    return {of.origin + 0.5 * (p + q), touch.depth, touch.feature_a, touch.feature_b, {}, {}};
}

void Gatherer::add_deepest() {
    const ContactPoint deepest = deepest_point(of_, touch_);
    int place = 0;
    while (place < points.count && !has_same_id(points.point[place], deepest)) ++place;
    points.point[place] = deepest;
    points.count = std::max(points.count, place + 1);
}

int gather_patches(const Patch& a, const Patch& b, const glm::dvec3& normal, Clipped& clipped, Gatherer& gatherer) {
    if (a.count < 2 || b.count < 2) return 0;
    if (a.count == 2 && b.count == 2) {
        gather_segments(a, b, normal, clipped, gatherer);
        return 0;
    }
    const double along_a = a.count > 2 ? glm::dot(a.normal, normal) : -1.0;
    const double along_b = b.count > 2 ? -glm::dot(b.normal, normal) : -1.0;
    const bool reference_is_a = along_a >= along_b - 1e-3 && a.count > 2;
    const glm::dvec3 out = reference_is_a ? normal : -normal;
    Prism sides;
    find_sides(reference_is_a ? a : b, out, gatherer.size(), sides);
    clip(reference_is_a ? a : b, sides, reference_is_a ? b : a, out, clipped);
    gatherer.add(clipped, reference_is_a);
    return reference_is_a ? 1 : 2;
}

void name_features(const Shape& a, const Shape& b, const Patch& patch_a, const Patch& patch_b, Touch& touch) {
    if (touch.known) return;
    const auto feature = [&](const Shape& shape, const int* vertices, const Feature& fallback) {
        return shape.has_polytope_core() && touch.vertex_count > 0 ? feature_of(shape, vertices, touch.vertex_count)
                                                                   : fallback;
    };
    touch.feature_a = feature(a, touch.vertices_a, patch_a.self);
    touch.feature_b = feature(b, touch.vertices_b, patch_b.self);
    touch.known = true;
}

void add_support(const Patch& face, const glm::dvec3& out, const glm::dvec3& deepest, int vertex, bool face_is_a,
                 Gatherer& gatherer) {
    const double steepness = face.count > 2 ? glm::dot(face.normal, out) : 0.0;
    if (!(steepness > 0.05)) return;
    Prism sides;
    find_sides(face, out, gatherer.size(), sides);
    for (int k = 0; k < sides.count; ++k)
        if (glm::dot(sides.outward[k], deepest) > sides.level[k]) return;
    const glm::dvec3 shadow = deepest - glm::dot(face.normal, deepest - face.point[0]) / steepness * out;
    const Feature corner{FeatureKind::vertex, static_cast<std::uint16_t>(vertex)};
    const int before = gatherer.points.count;
    if (face_is_a)
        gatherer.add(shadow, deepest, face.self, corner);
    else
        gatherer.add(deepest, shadow, corner, face.self);
    keep_ids_apart(gatherer.points, before);
}

}  // namespace crofton::convex
