// SPDX-License-Identifier: MIT
#include "brute_force.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace crofton::pipeline {
namespace {

// Twenty-odd roundings of 2^-53 relative to the largest number involved stay well below this.
constexpr double kPlaneError = 1e-13;

double size_of(const glm::dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

double signed_distance(const Frustum& frustum, const Plane& plane, const glm::dvec3& point) {
    return glm::dot(plane.normal, point - frustum.origin) + plane.offset;
}

// Sutherland–Hodgman; `grow` moves every plane outward.
bool survives_clipping(const Frustum& frustum, std::span<const glm::dvec3> polygon, double grow) {
    std::array<glm::dvec3, 8 + Frustum::kMaxPlanes> points, next;
    std::size_t count = polygon.size();
    std::copy(polygon.begin(), polygon.end(), points.begin());
    for (const Plane& plane : frustum.view()) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const glm::dvec3& a = points[i];
            const glm::dvec3& b = points[(i + 1) % count];
            const double da = signed_distance(frustum, plane, a) + grow, db = signed_distance(frustum, plane, b) + grow;
            if (da >= 0.0) next[kept++] = a;
            if ((da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0)) next[kept++] = a + (da / (da - db)) * (b - a);
        }
        if (kept == 0) return false;
        count = kept;
        std::swap(points, next);
    }
    return true;
}

double rounding_of(const Frustum& frustum, std::span<const glm::dvec3> points) {
    double size = size_of(frustum.origin);
    for (const glm::dvec3& p : points) size = std::max(size, size_of(p));
    for (const Plane& plane : frustum.view()) size = std::max(size, std::abs(plane.offset));
    return kPlaneError * size;
}

Truth both(bool surely, bool possibly) {
    return surely ? Truth::yes : possibly ? Truth::unclear : Truth::no;
}

}  // namespace

BodyTruth clip_polygon(const Frustum& frustum, std::span<const glm::dvec3> polygon) {
    const double rounding = rounding_of(frustum, polygon);
    bool surely_in = true, possibly_in = true;
    for (const Plane& plane : frustum.view()) {
        double low = INFINITY, high = -INFINITY;
        for (const glm::dvec3& p : polygon) {
            const double d = signed_distance(frustum, plane, p);
            low = std::min(low, d);
            high = std::max(high, d);
        }
        if (high < -rounding) return {Truth::no, Truth::no};
        surely_in = surely_in && low > rounding;
        possibly_in = possibly_in && low >= -rounding;
    }
    if (surely_in) return {Truth::yes, Truth::yes};
    return {both(survives_clipping(frustum, polygon, -rounding), survives_clipping(frustum, polygon, rounding)),
            both(surely_in, possibly_in)};
}

BodyTruth clip_box(const Frustum& frustum, const Obb& box, const glm::dvec3& interior) {
    const std::array<glm::dvec3, 8> p = corners(box);
    constexpr std::array<std::array<unsigned, 4>, 6> faces = {
        {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}}};
    BodyTruth result{Truth::no, Truth::yes};
    for (const auto& face : faces) {
        const glm::dvec3 quad[4] = {p[face[0]], p[face[1]], p[face[2]], p[face[3]]};
        const BodyTruth truth = clip_polygon(frustum, quad);
        if (truth.meets == Truth::yes || result.meets == Truth::no) result.meets = truth.meets;
        if (truth.contained == Truth::no || result.contained == Truth::yes) result.contained = truth.contained;
    }
    if (result.meets != Truth::yes && contains(box, interior)) result.meets = Truth::yes;
    return result;
}

BodyTruth clip_sphere(const Frustum& frustum, const glm::dvec3& center, double radius) {
    const double rounding = rounding_of(frustum, std::array{center, center + glm::dvec3(radius)});
    double lowest = INFINITY;
    for (const Plane& plane : frustum.view()) lowest = std::min(lowest, signed_distance(frustum, plane, center));
    return {both(lowest > rounding - radius, lowest >= -rounding - radius),
            both(lowest > rounding + radius, lowest >= radius - rounding)};
}

Truth boxes_meet(const Obb& a, const Obb& b) {
    std::array<glm::dvec3, 6> edges;  // half edges of a, then of b
    for (int k = 0; k < 3; ++k) {
        edges[static_cast<std::size_t>(k)] = glm::dvec3(a.axes[k]);
        edges[static_cast<std::size_t>(k + 3)] = glm::dvec3(b.axes[k]);
    }
    const glm::dvec3 d = b.center - a.center;
    const double size = std::max({size_of(a.center), size_of(b.center), double(a.half_extents.x),
                                  double(a.half_extents.y), double(a.half_extents.z), double(b.half_extents.x),
                                  double(b.half_extents.y), double(b.half_extents.z)});
    const double rounding = kPlaneError * size;
    bool unclear = false, skipped = false;
    double widest = -INFINITY;
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = i + 1; j < 6; ++j) {
            const glm::dvec3 axis = glm::cross(edges[i], edges[j]);
            const double length = glm::length(axis);
            // Edges parallel to 1e-9: the face normals say the same to within that much of the size.
            if (length < 1e-9) {
                skipped = true;
                continue;
            }
            double projected_radius = 0.0;
            for (int k = 0; k < 3; ++k)
                projected_radius +=
                    double(a.half_extents[k]) * std::abs(glm::dot(edges[static_cast<std::size_t>(k)], axis)) +
                    double(b.half_extents[k]) * std::abs(glm::dot(edges[static_cast<std::size_t>(k + 3)], axis));
            const double gap = (std::abs(glm::dot(d, axis)) - projected_radius) / length;
            if (gap > rounding / length) return Truth::no;
            unclear = unclear || gap > -rounding / length;
            widest = std::max(widest, gap);
        }
    unclear = unclear || (skipped && widest > -1e-8 * size);
    return unclear ? Truth::unclear : Truth::yes;
}

}  // namespace crofton::pipeline
