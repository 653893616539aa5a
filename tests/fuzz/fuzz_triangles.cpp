// SPDX-License-Identifier: MIT
// Pairs of triangles on a grid, and rays at them: against Carathéodory's theorem and determinants in rationals.
#include <crofton/mesh/mesh_query.hpp>
#include <optional>
#include <oracle/exact_triangles.hpp>

#include "shapes.hpp"

namespace {

using namespace crofton;
using fuzz::demand;

template <class Number>
Number triple(const oracle::Vec3<Number>& a, const oracle::Vec3<Number>& b, const oracle::Vec3<Number>& c) {
    return oracle::dot(oracle::cross(a, b), c);
}

// Where the ray's line passes through the triangle, if it does and the two are in no plane.
std::optional<double> crossing(const Ray& ray, const Triangle& t) {
    return oracle::decide([&]<class Number>() -> std::optional<double> {
        const auto d = oracle::vector_of<Number>(ray.direction), o = oracle::vector_of<Number>(ray.origin);
        const auto a = oracle::minus(oracle::vector_of<Number>(t[0]), o),
                   b = oracle::minus(oracle::vector_of<Number>(t[1]), o),
                   c = oracle::minus(oracle::vector_of<Number>(t[2]), o);
        const Number u = triple(d, b, c), v = triple(d, c, a), w = triple(d, a, b), sum = u + v + w;
        const int of_u = sgn(u), of_v = sgn(v), of_w = sgn(w);
        const bool below = of_u < 0 || of_v < 0 || of_w<0, above = of_u> 0 || of_v > 0 || of_w > 0;
        if (below == above) return std::nullopt;  // beside it, or all three are 0
        return oracle::quotient(triple(a, b, c), sum);
    });
}

}  // namespace

CROFTON_FUZZ(in) {
    const Triangle a = in.triangle();
    Triangle b = in.triangle();
    // Corners, or points of edges, in common.
    for (glm::dvec3& p : b) {
        const unsigned kind = in.below(4);
        if (kind == 0) p = a[in.below(3)];
        if (kind == 1) p = 0.5 * (a[in.below(3)] + a[in.below(3)]) + in.nudge();
    }
    const bool meet = oracle::triangles_meet_quickly(a, b);
    demand(mesh::intersects(a, b) == meet && mesh::intersects(b, a) == meet, "two triangles meet");
    if (meet) {
        const mesh::SegmentOfContact segment = mesh::contact_segment(a, b);
        double extent = 0.0;
        for (const Triangle& t : {a, b})
            for (const glm::dvec3& p : t) extent += glm::length(p);
        const auto finite = [&](const glm::dvec3& p) { return glm::length(p) <= extent * (1.0 + 1e-9); };
        demand(finite(segment.begin) && finite(segment.end), "the ends of a contact");
    }
    const Ray ray = in.flag() ? in.ray_through(a[in.below(3)]) : in.ray_through((a[0] + a[1] + a[2]) / 3.0);
    const auto hit = mesh::raycast(ray, a), line = crossing(ray, a);
    if (!line) return demand(!hit, "a ray that misses hits");
    // t is rounded, as far as between the nearest and the farthest corner.
    double low = *line, high = *line;
    for (const glm::dvec3& p : a) {
        const double t = glm::dot(p - ray.origin, ray.direction) / glm::dot(ray.direction, ray.direction);
        low = std::min(low, t);
        high = std::max(high, t);
    }
    const double rounding = 1e-9 * (1.0 + std::max(std::fabs(low), std::fabs(high)));
    if (low > rounding && high < ray.max_t - rounding) demand(hit.has_value(), "a ray passes through");
    if (high < -rounding || low > ray.max_t + rounding) demand(!hit, "a ray hits beyond its ends");
}
