// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/collide/narrow_phase.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace crofton::collide {
namespace {

struct Span {
    double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
};

Span span_along(const ConvexShape& body, const glm::dvec3& axis) {
    Span span;
    for (int i = 0; i < body.point_count; ++i) {
        const double along = glm::dot(body.points[i], axis);
        span.low = std::min(span.low, along);
        span.high = std::max(span.high, along);
    }
    return span;
}

void try_axis(const ConvexShape& a, const ConvexShape& b, const glm::dvec3& axis, Penetration& best) {
    const Span in_a = span_along(a, axis), in_b = span_along(b, axis);
    const double radii = a.radius + b.radius;
    const double forward = in_a.high - in_b.low + radii, backward = in_b.high - in_a.low + radii;
    if (forward < best.depth) best = {forward, axis};
    if (backward < best.depth) best = {backward, -axis};
}

}  // namespace

Penetration penetration(const ConvexShape& a, const ConvexShape& b) {
    Penetration best{std::numeric_limits<double>::infinity(), {}};
    for (int i = 0; i < a.normal_count; ++i)
        if (a.normals[i] != glm::dvec3(0.0)) try_axis(a, b, a.normals[i], best);
    for (int i = 0; i < b.normal_count; ++i)
        if (b.normals[i] != glm::dvec3(0.0)) try_axis(a, b, b.normals[i], best);
    // Products of nearly parallel edges are noise as directions. Being unit vectors they are still valid axes, and no
    // deeper answer than a face normal's is lost without them.
    for (int i = 0; i < a.edge_count; ++i)
        for (int j = 0; j < b.edge_count; ++j) {
            const glm::dvec3 n = glm::cross(a.edges[i], b.edges[j]);
            const double length = glm::length(n);
            if (length > 1e-6) try_axis(a, b, n / length, best);
        }
    // Round bodies, and those without an interior, also part along the line between their nearest points.
    const bool is_thin = a.normal_count < 3 || b.normal_count < 3 || a.radius + b.radius > 0.0;
    if (is_thin) {
        ConvexShape core_a = a, core_b = b;
        core_a.radius = core_b.radius = 0.0;
        const Distance core = distance(core_a, core_b);
        if (core.distance > 0.0) {
            best = {a.radius + b.radius - core.distance, (core.on_b - core.on_a) / core.distance};
        } else if (best.depth == std::numeric_limits<double>::infinity()) {
            try_axis(a, b, {0.0, 0.0, 1.0}, best);  // two points, or collinear segments, on top of each other
        }
    }
    return best;
}

Penetration penetration(const Plane& half_space, const ConvexShape& body) {
    const double length = glm::length(half_space.normal);
    if (!(length > 0.0)) return {-std::numeric_limits<double>::infinity(), {}};
    const glm::dvec3 inward = half_space.normal / length;
    const Span span = span_along(body, inward);
    return {span.high + body.radius + half_space.offset / length, -inward};
}

}  // namespace crofton::collide
