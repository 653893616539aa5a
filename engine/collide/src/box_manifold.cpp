// SPDX-License-Identifier: MIT
// Where two boxes touch. Everything is reckoned about the centre of one of them.
#include <algorithm>
#include <cmath>
#include <crofton/collide/convex_query.hpp>
#include <crofton/collide/obb_obb.hpp>
#include <glm/geometric.hpp>
#include <utility>

#include "box_penetration.hpp"
#include "manifold_points.hpp"

namespace crofton::collide {
namespace {

// A point of the incident face: its place on that face, and in the reference face's frame.
struct FacePoint {
    double across, along;  // in [-1, 1], by the incident face's two edges
    double side[2];        // distance from the reference box's centre towards its sides
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

// The part with sign · side[k] ≤ limit (Sutherland, Hodgman 1974).
void clip(FacePolygon& polygon, int k, double sign, double limit) {
    FacePolygon result;
    for (int i = 0; i < polygon.count; ++i) {
        const FacePoint &p = polygon.point[i], &q = polygon.point[i + 1 == polygon.count ? 0 : i + 1];
        const double at_p = sign * p.side[k] - limit, at_q = sign * q.side[k] - limit;
        if (at_p <= 0.0 && result.count < 8) result.point[result.count++] = p;
        if (((at_p < 0.0 && at_q > 0.0) || (at_p > 0.0 && at_q < 0.0)) && result.count < 8)
            result.point[result.count++] = between(p, q, at_p / (at_p - at_q));
    }
    polygon = result;
}

// The face of box `side` across axis k, looking along `outward`, which is its unit normal.
struct ReferenceFace {
    int side, k;
    glm::dvec3 outward;
};

// Points of the other box's face that looks against it most, within the reference box's sides and below the face.
void clip_faces(const BoxPairInDouble& pair, const ReferenceFace& reference, const glm::dvec3& center_a,
                Manifold& manifold) {
    const int side = reference.side, other = 1 - side;
    int incident = 0;
    double most = -1.0;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3& n = pair.normals[other][k];
        const double facing = std::abs(glm::dot(n, reference.outward)) / std::sqrt(glm::dot(n, n));
        if (facing > most + 1e-9) most = facing, incident = k;  // the first of equals, on every machine
    }
    const double sign = glm::dot(pair.normals[other][incident], reference.outward) *
                                    glm::dot(pair.normals[other][incident], pair.axes[other][incident]) >
                                0.0
                            ? -1.0
                            : 1.0;
    const int i = (incident + 1) % 3, j = (incident + 2) % 3;
    const glm::dvec3 u = pair.axes[other][i] * pair.half[other][i], v = pair.axes[other][j] * pair.half[other][j];
    const glm::dvec3 middle =
        (side == 0 ? pair.offset : -pair.offset) + pair.axes[other][incident] * (sign * pair.half[other][incident]);

    const int sides[2] = {(reference.k + 1) % 3, (reference.k + 2) % 3};
    glm::dvec3 toward[2];
    double limit[2];
    for (int s = 0; s < 2; ++s) {
        const glm::dvec3& n = pair.normals[side][sides[s]];
        toward[s] = n / std::sqrt(glm::dot(n, n));
        // Wider by the rounding of a point's place, so that faces without width keep their points.
        limit[s] =
            pair.half[side][sides[s]] * std::abs(glm::dot(pair.axes[side][sides[s]], toward[s])) + 0x1p-49 * pair.size;
    }
    const double height =
        pair.half[side][reference.k] * std::abs(glm::dot(pair.axes[side][reference.k], reference.outward));

    FacePolygon polygon;
    for (const auto& [across, along] : {std::pair(-1.0, -1.0), {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}}) {
        const glm::dvec3 p = middle + across * u + along * v;
        polygon.point[polygon.count++] = {
            across, along, {glm::dot(p, toward[0]), glm::dot(p, toward[1])}, height - glm::dot(p, reference.outward)};
    }
    for (int s = 0; s < 2; ++s)
        for (const double direction : {-1.0, 1.0}) clip(polygon, s, direction, limit[s]);

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
        const glm::dvec3 place = middle + p.across * u + p.along * v + (0.5 * depth) * reference.outward;
        add_point({origin + place, depth}, error_bound, manifold);
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
const AxisOverlap& contact_axis(const BoxOverlap& overlap) {
    constexpr double kSquaredCosine = 0.9998;
    const AxisOverlap& least = least_of(overlap);
    if (least.number < 6) return least;
    const AxisOverlap* face = nullptr;
    for (const AxisOverlap& candidate : overlap.faces) {
        const double product = glm::dot(candidate.axis, least.axis);
        if (product * product < kSquaredCosine * candidate.squared_length * least.squared_length) continue;
        if (face == nullptr || candidate.is_less_than(*face)) face = &candidate;
    }
    return face == nullptr ? least : *face;
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
    const BoxOverlap overlap = overlap_of(a, b, pair);
    if (overlap.surely_apart() || (!overlap.surely_meet() && !intersects(a, b))) return manifold;
    const AxisOverlap& axis = contact_axis(overlap);
    glm::dvec3 normal = axis.axis / std::sqrt(axis.squared_length);
    if (glm::dot(normal, pair.offset) < 0.0) normal = -normal;
    manifold.normal = normal;
    if (axis.number < 3)
        clip_faces(pair, {0, axis.number, normal}, a.center, manifold);
    else if (axis.number < 6)
        clip_faces(pair, {1, axis.number - 3, -normal}, a.center, manifold);
    else
        cross_edges(pair, axis.number, normal, std::max(0.0, axis.depth()), a.center, manifold);
    if (manifold.count == 0) touch_somewhere(a, b, manifold);
    if (points == ManifoldPoints::reduced) reduce(manifold);
    set_depth(manifold);
    return manifold;
}

}  // namespace crofton::collide
