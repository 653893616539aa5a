// SPDX-License-Identifier: MIT
// Contact points of two boxes, computed relative to the centre of one of them.
#include <algorithm>
#include <cmath>
#include <crofton/collide/bound_contacts.hpp>
#include <glm/geometric.hpp>

#include "box_penetration.hpp"
#include "careful_axis.hpp"
#include "manifold_points.hpp"

namespace crofton::collide {
namespace {

// A point of the incident face: its place on that face, and in the reference face's frame.
struct FacePoint {
    double across, along;  // in [-1, 1], by the incident face's two edges
    double side[2];        // from the reference box's centre towards its sides, times a length near 1
    double depth;          // below the reference face
};

FacePoint between(const FacePoint& p, const FacePoint& q, double t) {
    return {p.across + t * (q.across - p.across),
            p.along + t * (q.along - p.along),
            {p.side[0] + t * (q.side[0] - p.side[0]), p.side[1] + t * (q.side[1] - p.side[1])},
            p.depth + t * (q.depth - p.depth)};
}

// A convex polygon of four corners gains at most one from each of the four sides it is clipped by.
struct FacePolygon {
    FacePoint point[8];
    int count = 0;
};

// The part of `from` with sign · side[k] ≤ limit (Sutherland, Hodgman 1974), in `to`; false, and nothing written, where
// that is all of it.
bool clip(const FacePolygon& from, int k, double sign, double limit, FacePolygon& to) {
    double beyond[8];
    bool any = false;
    for (int i = 0; i < from.count; ++i) {
        beyond[i] = sign * from.point[i].side[k] - limit;
        any |= beyond[i] > 0.0;
    }
    if (!any) return false;
    to.count = 0;
    for (int i = 0; i < from.count; ++i) {
        const int j = i + 1 == from.count ? 0 : i + 1;
        const double at_p = beyond[i], at_q = beyond[j];
        if (at_p <= 0.0 && to.count < 8) to.point[to.count++] = from.point[i];
        if (((at_p < 0.0 && at_q > 0.0) || (at_p > 0.0 && at_q < 0.0)) && to.count < 8)
            to.point[to.count++] = between(from.point[i], from.point[j], at_p / (at_p - at_q));
    }
    return true;
}

// The face of box `side` across axis k, looking along `outward`, which is its unit normal.
struct ReferenceFace {
    int side, k;
    glm::dvec3 outward;
};

// The face of the other box that looks against the reference face most.
struct IncidentFace {
    IncidentFace(const BoxPairInDouble& pair, const ReferenceFace& reference) {
        const int other = 1 - reference.side;
        int k = 0;
        double along = 0.0, most = -1.0;
        for (int i = 0; i < 3; ++i) {
            const double facing = glm::dot(pair.axes[other][i], reference.outward);
            if (std::abs(facing) > most + 1e-9) most = std::abs(facing), along = facing, k = i;  // the first of equals
        }
        const int i = k == 2 ? 0 : k + 1, j = i == 2 ? 0 : i + 1;
        u = pair.axes[other][i] * pair.half[other][i];
        v = pair.axes[other][j] * pair.half[other][j];
        middle = (reference.side == 0 ? pair.offset : -pair.offset) +
                 pair.axes[other][k] * (along > 0.0 ? -pair.half[other][k] : pair.half[other][k]);
    }
    glm::dvec3 middle, u, v;  // from the reference box's centre; half edges
};

// The corners of a face by their coordinates in the reference face's frame, each a sum of three numbers.
FacePolygon polygon_of(const IncidentFace& face, const glm::dvec3 (&toward)[2], const glm::dvec3& outward,
                       double height) {
    constexpr double kAcross[4] = {-1.0, 1.0, 1.0, -1.0}, kAlong[4] = {-1.0, -1.0, 1.0, 1.0};
    const auto at_corner = [&](const glm::dvec3& direction, int n) {
        return glm::dot(face.middle, direction) +
               (kAcross[n] * glm::dot(face.u, direction) + kAlong[n] * glm::dot(face.v, direction));
    };
    FacePolygon polygon;
    for (int n = 0; n < 4; ++n)
        polygon.point[n] = {
            kAcross[n], kAlong[n], {at_corner(toward[0], n), at_corner(toward[1], n)}, height - at_corner(outward, n)};
    polygon.count = 4;
    return polygon;
}

// Adds a corner of the polygon unless it is the one before or the first: equal ones are neighbours around it.
void add_corner(const ContactPoint& point, double error_bound, Manifold& manifold) {
    for (const int i : {0, manifold.count - 1}) {
        if (i < 0 || manifold.count == 0) break;
        const glm::dvec3 apart = manifold.points[i].position - point.position;
        if (glm::dot(apart, apart) <= error_bound * error_bound) return;
    }
    manifold.points[manifold.count++] = point;
}

// Points of the other box's face that looks against it most, within the reference box's sides and below the face.
void clip_faces(const BoxPairInDouble& pair, const ReferenceFace& reference, const glm::dvec3& center_a,
                Manifold& manifold) {
    const int side = reference.side, k = reference.k;
    const IncidentFace face(pair, reference);
    const int sides[2] = {k == 2 ? 0 : k + 1, k == 0 ? 2 : k - 1};
    const glm::dvec3 toward[2] = {pair.normal(side, sides[0]), pair.normal(side, sides[1])};
    const double height = pair.half[side][k] * std::abs(glm::dot(pair.axes[side][k], reference.outward));

    FacePolygon polygons[2] = {polygon_of(face, toward, reference.outward, height), {}};
    int now = 0;
    for (int s = 0; s < 2; ++s) {
        // Wider by the rounding of a point's place, so that faces without width keep their points.
        const double limit =
            pair.half[side][sides[s]] * std::abs(glm::dot(pair.axes[side][sides[s]], toward[s])) + 0x1p-49 * pair.size;
        for (const double direction : {-1.0, 1.0})
            if (clip(polygons[now], s, direction, limit, polygons[1 - now])) now = 1 - now;
    }
    const FacePolygon& polygon = polygons[now];

    const glm::dvec3 origin = side == 0 ? center_a : center_a + pair.offset;
    double deepest = -1e-12 * pair.size;  // points above the face by rounding alone touch it
    for (int n = 0; n < polygon.count; ++n) deepest = std::max(deepest, polygon.point[n].depth);
    const double least = std::min(deepest, 0.0);
    const glm::dvec3 far = glm::abs(origin);
    const double error_bound = 0x1p-46 * pair.size + 0x1p-51 * (far.x + far.y + far.z);
    for (int n = 0; n < polygon.count; ++n) {
        const FacePoint& p = polygon.point[n];
        if (!(p.depth >= least)) continue;
        const double depth = std::max(p.depth, 0.0);
        const glm::dvec3 place = face.middle + p.across * face.u + p.along * face.v + (0.5 * depth) * reference.outward;
        add_corner({origin + place, depth}, error_bound, manifold);
    }
}

// The middle of the nearest points of the two edges that face each other along the axis.
void cross_edges(const BoxPairInDouble& pair, int number, const glm::dvec3& axis, double depth,
                 const glm::dvec3& center_a, Manifold& manifold) {
    const int edge[2] = {(number - 6) / 3, (number - 6) % 3};
    glm::dvec3 middle[2] = {glm::dvec3(0.0), pair.offset};
    for (int side = 0; side < 2; ++side)
        for (int k = 0; k < 3; ++k) {
            if (k == edge[side]) continue;
            const double slope = glm::dot(pair.axes[side][k], axis) * (side == 0 ? 1.0 : -1.0);
            middle[side] += (slope >= 0.0 ? pair.half[side][k] : -pair.half[side][k]) * pair.axes[side][k];
        }
    // Both lines' points nearest to the other, within the edges: cross products keep their precision where the edges
    // are nearly parallel.
    const glm::dvec3 &u = pair.axes[0][edge[0]], &v = pair.axes[1][edge[1]];
    const glm::dvec3 n = glm::cross(u, v), between = middle[1] - middle[0];
    const double squared = glm::dot(n, n);
    const double hu = pair.half[0][edge[0]], hv = pair.half[1][edge[1]];
    const double s = std::clamp(glm::dot(glm::cross(between, v), n) / squared, -hu, hu);
    const double t = std::clamp(glm::dot(glm::cross(between, u), n) / squared, -hv, hv);
    manifold.points[manifold.count++] = {center_a + 0.5 * ((middle[0] + s * u) + (middle[1] + t * v)), depth};
}

// The axis of the contact: that of the least overlap, but a face's where the least is that of edges and looks along a
// face to within 0.8°. Faces that nearly lie on each other touch in an area, not in the crossing of two edges.
int contact_axis(const BoxPairInDouble& pair, const AxisMeasures& measures) {
    constexpr double kSquaredCosine = 0.9998;
    const int least = least_axis(measures);
    if (least < 6) return least;
    const glm::dvec3 edge = pair.axis(least);
    const double edge_length = squared_length(measures, least);
    int chosen = least;
    double depth = 0.0;
    for (int face = 0; face < 6; ++face) {
        const double product = glm::dot(pair.axes[face / 3][face % 3], edge);
        if (product * product < 0.99 * kSquaredCosine * edge_length)
            continue;  // stored axes are within 1e-4 of normals
        const double along = glm::dot(pair.normal(face / 3, face % 3), edge);
        if (along * along < kSquaredCosine * squared_length(measures, face) * edge_length) continue;
        const double face_depth = depth_along(measures, face);
        if (chosen == least || face_depth < depth) chosen = face, depth = face_depth;
    }
    return chosen;
}

// Boxes that meet where neither a face nor an edge says so: by less than rounding tells.
void touch_somewhere(const Obb& a, const Obb& b, Manifold& manifold) {
    const Distance nearest = distance(a, b);
    manifold.points[manifold.count++] = {0.5 * (nearest.on_a + nearest.on_b), 0.0};
}

}  // namespace

Manifold contact_manifold(const Obb& a, const Obb& b, ManifoldPoints points) {
    Manifold manifold;
    const BoxPairInDouble pair(a, b);
    const AxisMeasures measures = measures_of(a, b);
    if (measures.surely_apart || (!measures.surely_meet && careful_axis(a, b) != kNotSeparated)) return manifold;
    const int axis = contact_axis(pair, measures);
    glm::dvec3 normal = pair.axis(axis) / std::sqrt(squared_length(measures, axis));
    if (glm::dot(normal, pair.offset) < 0.0) normal = -normal;
    manifold.normal = normal;
    if (axis < 3)
        clip_faces(pair, {0, axis, normal}, a.center, manifold);
    else if (axis < 6)
        clip_faces(pair, {1, axis - 3, -normal}, a.center, manifold);
    else
        cross_edges(pair, axis, normal, std::max(0.0, depth_along(measures, axis)), a.center, manifold);
    if (manifold.count == 0) touch_somewhere(a, b, manifold);
    if (points == ManifoldPoints::reduced) reduce(manifold);
    set_depth(manifold);
    return manifold;
}

}  // namespace crofton::collide
