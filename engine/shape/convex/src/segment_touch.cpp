// SPDX-License-Identifier: MIT
// How a sphere or a capsule touches a triangle, by the nearest points of a segment.
#include <cmath>
#include <limits>

#include "pair.hpp"
#include "triangle_touch.hpp"

namespace crofton::convex {
namespace {

constexpr Feature kFace{FeatureKind::face, 0};

Feature end_feature(int end) {
    return {FeatureKind::vertex, static_cast<std::uint16_t>(end)};
}

// Of the nearest points so far; `squared` is their distance, squared.
struct NearestPair {
    double squared = std::numeric_limits<double>::infinity();
    glm::dvec3 on_triangle{0.0}, on_segment{0.0};
    Feature of_triangle{}, of_segment{};
};

double clamped(double s) {
    return s > 0.0 ? (s < 1.0 ? s : 1.0) : 0.0;
}

Feature feature_of_edge(int k, double s) {
    const auto vertex = [](int at) { return Feature{FeatureKind::vertex, static_cast<std::uint16_t>(at)}; };
    if (s == 0.0) return vertex(k);
    return s == 1.0 ? vertex(k == 2 ? 0 : k + 1) : Feature{FeatureKind::edge, static_cast<std::uint16_t>(k)};
}

// Of a point that is outside some of the triangle's edges: one of these has the nearest point. Each number is what
// offer_edge() would come to.
void offer_edges(NearestPair& best, const PlacedTriangle& t, const glm::dvec3 (&edge)[3], const double (&inward)[3],
                 const glm::dvec3& q) {
    int nearest = -1;
    double place = 0.0;
    for (int k = 0; k < 3; ++k) {
        if (inward[k] >= 0.0) continue;
        const glm::dvec3 &p = t.corner[k], &u = edge[k];
        const double uu = glm::dot(u, u), s = uu > 0.0 ? clamped(-glm::dot(u, p - q) / uu) : 0.0;
        const glm::dvec3 way = q - (p + s * u);
        if (const double d = glm::dot(way, way); d < best.squared) best.squared = d, nearest = k, place = s;
    }
    if (nearest < 0) return;
    best.on_triangle = t.corner[nearest] + place * edge[nearest];
    best.on_segment = q;
    best.of_triangle = feature_of_edge(nearest, place);
    best.of_segment = end_feature(0);
}

// Of an end of the segment above the face.
void offer_face(NearestPair& best, const glm::dvec3& p, const glm::dvec3& q, int end) {
    const glm::dvec3 way = q - p;
    if (const double squared = glm::dot(way, way); squared < best.squared)
        best = {squared, p, q, kFace, end_feature(end)};
}

// Of edge k of the triangle, from p along u, and the segment from q along v; v may be 0.
void offer_edge(NearestPair& best, int k, const glm::dvec3& p, const glm::dvec3& u, const glm::dvec3& q,
                const glm::dvec3& v) {
    const glm::dvec3 r = p - q;
    const double uu = glm::dot(u, u), vv = glm::dot(v, v), uv = glm::dot(u, v), ur = glm::dot(u, r),
                 vr = glm::dot(v, r);
    const double whole = uu * vv - uv * uv;
    double s = whole > 0.0 ? clamped((uv * vr - ur * vv) / whole) : 0.0;
    const double t = vv > 0.0 ? clamped((uv * s + vr) / vv) : 0.0;
    s = uu > 0.0 ? clamped((uv * t - ur) / uu) : 0.0;
    const glm::dvec3 on_edge = p + s * u, on_segment = q + t * v, way = on_segment - on_edge;
    const double squared = glm::dot(way, way);
    if (!(squared < best.squared)) return;
    const Feature of_segment = t == 0.0 ? end_feature(0) : t == 1.0 ? end_feature(1) : Feature{FeatureKind::edge, 0};
    best = {squared, on_edge, on_segment, feature_of_edge(k, s), of_segment};
}

}  // namespace

PlacedTriangle placed_corners(const Triangle& corners, const RigidTransform& pose, const glm::dvec3& origin) {
    const glm::dvec3 offset = pose.translation - origin;
    PlacedTriangle t;
    for (std::size_t k = 0; k < 3; ++k) t.corner[k] = pose.rotation * corners[k] + offset;
    return t;
}

PlacedTriangle placed_triangle(const Triangle& corners, const RigidTransform& pose, const glm::dvec3& origin) {
    PlacedTriangle t = placed_corners(corners, pose, origin);
    t.normal = triangle_normal(pose.rotation, corners);
    return t;
}

SegmentTouch::SegmentTouch(const ShapeAtPose& shape, const glm::dvec3& origin, double reach, double margin)
    : count_(shape.shape.vertex_count()), radius_(shape.shape.radius()), limit_(shape.shape.radius() + margin) {
    const glm::dvec3 offset = shape.pose.translation - origin;
    for (int i = 0; i < 2; ++i) end_[i] = shape.pose.rotation * shape.shape.vertex(std::min(i, count_ - 1)) + offset;
    const double size = reach + shape.shape.core_radius() + glm::length(offset);
    error_ = 0x1p-48 * size;
    doubt_ = kRoundedDoubt * size + 2.0 * error_;
}

Warm SegmentTouch::ask(const PlacedTriangle& t, Touch& touch, double* gap) const {
    if (t.normal == glm::dvec3(0.0) || !(error_ < std::numeric_limits<double>::infinity())) return Warm::unknown;
    const glm::dvec3 edge[3] = {t.corner[1] - t.corner[0], t.corner[2] - t.corner[1], t.corner[0] - t.corner[2]};
    // The corners of a sliver are not quite on its rounded plane.
    const double second = glm::dot(t.normal, edge[0]), third = -glm::dot(t.normal, edge[2]);
    const double top = std::max(0.0, std::max(second, third)), bottom = std::min(0.0, std::min(second, third));
    const double height[2] = {glm::dot(t.normal, end_[0] - t.corner[0]), glm::dot(t.normal, end_[1] - t.corner[0])};
    const double low = std::min(height[0], height[1]), high = std::max(height[0], height[1]), far = limit_ + doubt_;
    if (low - top > far || high - bottom < -far) return Warm::apart;
    NearestPair best;
    for (int i = 0; i < count_; ++i) {
        double inward[3];
        for (int k = 0; k < 3; ++k) inward[k] = glm::dot(glm::cross(edge[k], end_[i] - t.corner[k]), t.normal);
        if (inward[0] >= 0.0 && inward[1] >= 0.0 && inward[2] >= 0.0)
            offer_face(best, end_[i] - height[i] * t.normal, end_[i], i);
        else if (count_ == 1)
            offer_edges(best, t, edge, inward, end_[i]);
    }
    if (count_ > 1)
        for (int k = 0; k < 3; ++k) offer_edge(best, k, t.corner[k], edge[k], end_[0], end_[1] - end_[0]);
    const double distance = std::sqrt(best.squared);
    // Nearer than this the direction is rounding.
    if (!(distance > 0x1p16 * error_)) return Warm::unknown;
    const glm::dvec3 n = (best.on_segment - best.on_triangle) / distance;
    const double lower =
        std::min(glm::dot(n, end_[0] - best.on_triangle), glm::dot(n, end_[1] - best.on_triangle)) -
        std::max(glm::dot(n, t.corner[0] - best.on_triangle),
                 std::max(glm::dot(n, t.corner[1] - best.on_triangle), glm::dot(n, t.corner[2] - best.on_triangle)));
    if (lower - doubt_ > limit_) return Warm::apart;
    // Whether shapes as near to a touch as this meet is left to the search that decides it for all queries.
    if (!(distance - lower <= 64.0 * error_)) return Warm::unknown;
    if (std::abs(distance - radius_) <= doubt_) {
        if (gap != nullptr) *gap = distance - radius_ + 64.0 * error_;
        return Warm::unknown;
    }
    touch.normal = n;
    touch.depth = radius_ - distance;
    touch.on_a = best.on_triangle;
    touch.on_b = best.on_segment;
    touch.feature_a = best.of_triangle;
    touch.feature_b = best.of_segment;
    touch.known = true;
    return touch.depth >= -limit_ + radius_ ? Warm::touching : Warm::apart;
}

}  // namespace crofton::convex
