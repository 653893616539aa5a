// SPDX-License-Identifier: MIT
// How a box touches a triangle, by 13 axes (triangle_touch.hpp).
#include <cmath>
#include <glm/matrix.hpp>
#include <limits>

#include "triangle_touch.hpp"

namespace crofton::convex {

// A covector of the box's frame, and the extent of the difference body (triangle less box) along it.
struct BoxTouch::Axis {
    glm::dvec3 m{0.0};
    double extent = std::numeric_limits<double>::infinity();
    double length = 1.0;  // of m in the world
    int number = -1;  // 0: the triangle's face; 1 + k: the box's; 4 + 3k + j: edge k of the box and j of the triangle
};

// The triangle in the box's frame.
struct BoxTouch::Local {
    glm::dvec3 corner[3], edge[3], normal;  // the normal of any length
    double longest;                         // edge, squared
    double squared_reach;                   // of the difference body; at most twice too large
};

namespace {

// (1e-5)² of the difference body's reach, squared, with (a + b)² ≤ 2 a² + 2 b².
constexpr double kUncertain = 2e-10;

// Of the size. Rounding moves an axis's extent by 1e-10. Each edge of the triangle that is parallel to one of the box
// is left out, which may lose as much.
constexpr double kDepthError = 4e-10;

double length_of(const glm::dmat3& metric, const glm::dvec3& m) {
    return std::sqrt(glm::dot(m, metric * m));
}

}  // namespace

BoxTouch::BoxTouch(const ShapeAtPose& box, const glm::dvec3& origin, double reach, double margin)
    : box_(box), offset_(box.pose.translation - origin), half_(box.shape.half_extents()), margin_(margin) {
    to_local_ = glm::inverse(box.pose.rotation);
    metric_ = to_local_ * glm::transpose(to_local_);
    for (int k = 0; k < 3; ++k) unit_[k] = std::sqrt(metric_[k][k]);
    size_ = reach + box.shape.core_radius() + glm::length(offset_);
    error_ = 0x1p-48 * size_;
}

// Faces come first, and another axis must be less deep by more than rounding, so that the choice does not flicker.
void BoxTouch::try_faces(const Local& t, Axis& least) const {
    const glm::dvec3& n = t.normal;
    const double radius = glm::dot(half_, glm::abs(n)), length = length_of(metric_, n);
    // All corners count: a sliver's normal is rounded, and across none of its edges.
    const double along[3] = {glm::dot(n, t.corner[0]), glm::dot(n, t.corner[1]), glm::dot(n, t.corner[2])};
    const double front = std::max(along[0], std::max(along[1], along[2])) + radius,
                 behind = radius - std::min(along[0], std::min(along[1], along[2]));
    least = {front <= behind ? n : -n, std::min(front, behind) / length, length, 0};
    const double depth_margin = kSameDepth * size_;
    for (int k = 0; k < 3; ++k) {
        const double p = t.corner[0][k], q = t.corner[1][k], r = t.corner[2][k];
        const double above = std::max(p, std::max(q, r)) + half_[k], below = half_[k] - std::min(p, std::min(q, r));
        const double extent = std::min(above, below) / unit_[k];
        if (!(extent < least.extent - depth_margin)) continue;
        least = {glm::dvec3(0.0), extent, unit_[k], 1 + k};
        least.m[k] = above <= below ? 1.0 : -1.0;
    }
}

// False where an axis is not certain enough.
bool BoxTouch::try_edges(const Local& t, Axis& least) const {
    const double uncertain = kUncertain * t.squared_reach, parallel = 1e-20 * size_ * size_,
                 depth_margin = kSameDepth * size_;
    bool certain = true;
    for (int k = 0; k < 3; ++k) {
        const int u = k == 2 ? 0 : k + 1, v = k == 0 ? 2 : k - 1;
        const double uu = metric_[u][u], uv = 2.0 * metric_[u][v], vv = metric_[v][v];
        for (int j = 0; j < 3; ++j) {
            const glm::dvec3 &e = t.edge[j], &on = t.corner[j], &off = t.corner[j == 0 ? 2 : j - 1];
            const double mu = -e[v], mv = e[u];  // across axis k and the edge
            const double p = mu * on[u] + mv * on[v], q = mu * off[u] + mv * off[v];
            const double radius = half_[u] * std::abs(mu) + half_[v] * std::abs(mv);
            const double above = std::max(p, q) + radius, below = radius - std::min(p, q);
            const double extent = std::min(above, below), squared = (uu * mu * mu + vv * mv * mv) + uv * mu * mv;
            const double best = least.extent - depth_margin;
            // Most axes are deeper, which needs no root to be seen.
            if (best >= 0.0 && extent >= 0.0 && extent * extent > best * best * squared && squared >= uncertain)
                continue;
            if (!(squared >= uncertain)) {
                certain = certain && squared <= parallel;
                continue;
            }
            const double length = std::sqrt(squared);
            if (!(extent / length < best)) continue;
            least = {glm::dvec3(0.0), extent / length, length, 4 + 3 * k + j};
            least.m[u] = above <= below ? mu : -mu;
            least.m[v] = above <= below ? mv : -mv;
        }
    }
    return certain;
}

int BoxTouch::lowest_corner(const glm::dvec3& m) const {
    return (m.x <= 0.0 ? 1 : 0) + (m.y <= 0.0 ? 2 : 0) + (m.z <= 0.0 ? 4 : 0);
}

Warm BoxTouch::ask(const PlacedTriangle& triangle, Touch& touch) const {
    if (!(size_ < std::numeric_limits<double>::infinity())) return Warm::unknown;
    Local t;
    for (int v = 0; v < 3; ++v) t.corner[v] = to_local_ * (triangle.corner[v] - offset_);
    const double doubt = box_.shape.radius() > 0.0 ? (kSameDepth + kDepthError) * size_ : 0.0;
    const double limit = -(margin_ + box_.shape.radius()) - 2.0 * error_ - doubt;
    for (int k = 0; k < 3; ++k) {
        const double p = t.corner[0][k], q = t.corner[1][k], r = t.corner[2][k];
        const double nearest = std::max(std::min(p, std::min(q, r)), -std::max(p, std::max(q, r)));
        if (half_[k] - nearest < limit * unit_[k]) return Warm::apart;
    }
    for (int v = 0; v < 3; ++v) t.edge[v] = t.corner[v == 2 ? 0 : v + 1] - t.corner[v];
    t.normal = glm::cross(t.edge[0], t.edge[1]);
    t.longest = t.squared_reach = 0.0;
    for (const glm::dvec3& e : t.edge) t.longest = std::max(t.longest, glm::dot(e, e));
    for (const glm::dvec3& p : t.corner) t.squared_reach = std::max(t.squared_reach, glm::dot(p, p));
    t.squared_reach += glm::dot(half_, half_);
    // The direction of a sliver's face is as uncertain as that of nearly parallel edges.
    if (!(glm::dot(t.normal, t.normal) > kUncertain * t.squared_reach * t.longest)) return Warm::unknown;
    Axis least;
    try_faces(t, least);
    if (least.extent < limit) return Warm::apart;
    const bool certain = try_edges(t, least);
    if (least.extent < limit) return Warm::apart;
    // Another axis may be less deep, and part the shapes.
    if (!certain || !(std::abs(least.extent) > (kSameDepth + kDepthError) * size_)) return Warm::unknown;
    const glm::dvec3 normal = Pair::local(to_local_, least.m);
    touch.normal = normal / glm::length(normal);
    if (!set_points(t, least, triangle, touch)) return Warm::unknown;
    touch.known = true;
    touch.depth = least.extent + box_.shape.radius();
    // Whether shapes as near to a touch as this meet is left to the search that decides it for all queries.
    if (doubt > 0.0 && std::abs(touch.depth) <= doubt) return Warm::unknown;
    return touch.depth >= -margin_ ? Warm::touching : Warm::apart;
}

// Shapes that are apart are as far apart as along the axis iff the points along it are within both faces; false if not.
bool BoxTouch::set_points(const Local& t, const Axis& axis, const PlacedTriangle& triangle, Touch& touch) const {
    const bool apart = axis.extent < 0.0;
    const glm::dvec3 way = axis.extent / axis.length * (metric_ * axis.m);  // from the point of b to that of a
    if (axis.number == 0) {
        const int corner = lowest_corner(axis.m);
        const glm::dvec3 x((corner & 1) != 0 ? half_.x : -half_.x, (corner & 2) != 0 ? half_.y : -half_.y,
                           (corner & 4) != 0 ? half_.z : -half_.z);
        const glm::dvec3 foot = x + way;
        for (int j = 0; apart && j < 3; ++j)
            if (!(glm::dot(glm::cross(t.edge[j], foot - t.corner[j]), t.normal) >= 0.0)) return false;
        touch.on_b = box_.pose.rotation * x + offset_;
        touch.on_a = touch.on_b + axis.extent * touch.normal;
        touch.feature_a = {FeatureKind::face, 0};
        touch.feature_b = {FeatureKind::vertex, static_cast<std::uint16_t>(corner)};
        return true;
    }
    if (axis.number < 4) {
        const int k = axis.number - 1;
        int farthest = 0;
        for (int v = 1; v < 3; ++v)
            if (axis.m[k] * (t.corner[v][k] - t.corner[farthest][k]) > 0.0) farthest = v;
        const glm::dvec3 foot = t.corner[farthest] - way;
        for (int j = 0; apart && j < 3; ++j)
            if (j != k && !(std::abs(foot[j]) <= half_[j])) return false;
        touch.on_a = triangle.corner[farthest];
        touch.on_b = touch.on_a - axis.extent * touch.normal;
        touch.feature_a = {FeatureKind::vertex, static_cast<std::uint16_t>(farthest)};
        touch.feature_b = {FeatureKind::face, static_cast<std::uint16_t>(2 * k + (axis.m[k] < 0.0 ? 1 : 0))};
        return true;
    }
    if (apart) return false;
    const int k = (axis.number - 4) / 3, j = (axis.number - 4) % 3;
    const int from = lowest_corner(axis.m) & ~(1 << k), ends[2] = {from, from | 1 << k};
    glm::dvec3 start;
    for (int i = 0; i < 3; ++i) start[i] = (from >> i & 1) != 0 ? half_[i] : -half_[i];
    // Where the edges cross, seen along the axis.
    const glm::dvec3 edge = triangle.corner[j == 2 ? 0 : j + 1] - triangle.corner[j],
                     to_start = box_.pose.rotation * start + offset_ - triangle.corner[j],
                     side = glm::cross(box_.pose.rotation[k], touch.normal);
    const double s = glm::dot(to_start, side) / glm::dot(edge, side);
    touch.on_a = triangle.corner[j] + std::min(std::max(s, 0.0), 1.0) * edge;
    touch.on_b = touch.on_a - axis.extent * touch.normal;
    touch.feature_a = {FeatureKind::edge, static_cast<std::uint16_t>(j)};
    touch.feature_b = feature_of(box_.shape, ends, 2);
    return true;
}

}  // namespace crofton::convex
