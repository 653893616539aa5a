// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/geometry/predicates.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/study/diameter.hpp>
#include <glm/geometric.hpp>
#include <string>

#include "exact_cross.hpp"

namespace crofton::study {
namespace {

template <class Point>
void consider(const Point& a, const Point& b, Diameter<Point>& best) {
    if (const double length = glm::distance(a, b); length > best.length) best = {length, a, b};
}

// Whether (b − a) × (d − c) > 0, exactly: a filter with Shewchuk's bound as in predicates.hpp, then expansions.
bool turns_left(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& d) {
    const double left = (b.x - a.x) * (d.y - c.y), right = (b.y - a.y) * (d.x - c.x);
    const double cross = left - right;
    if (std::abs(cross) >= detail::kOrientationBound * (std::abs(left) + std::abs(right))) return cross > 0.0;
    return exact_cross(a, b, c, d).sign() > 0;
}

// Below this, squares of coordinates and of their differences may be no normal doubles.
constexpr double kTiny = 0x1p-400;

// That of points made larger by a power of two, in their own size: nothing but the length is rounded.
template <class Point, class Find>
Result<Diameter<Point>> by_larger_points(std::span<const Point> points, double largest, Find find) {
    const int exponent = std::ilogb(largest);
    const auto scaled = [](Point p, int by) {
        for (int k = 0; k < Point::length(); ++k) p[k] = std::ldexp(p[k], by);
        return p;
    };
    Vector<Point> larger;
    for (const Point& p : points) larger.push_back(scaled(p, -exponent));
    const Result<Diameter<Point>> found = find(std::span<const Point>(larger));
    if (!found) return found.error();
    return Diameter<Point>{std::ldexp(found->length, exponent), scaled(found->from, exponent),
                           scaled(found->to, exponent)};
}

// By rotating calipers around the hull.
Result<Diameter<glm::dvec2>> planar_diameter(std::span<const glm::dvec2> points) {
    const auto hull = measure::convex_hull(points);
    if (!hull) return hull.error();
    const Vector<glm::dvec2>& p = *hull;
    Diameter<glm::dvec2> best{0.0, p[0], p[0]};
    const auto at = [&](std::size_t i) -> const glm::dvec2& { return p[i < p.size() ? i : i % p.size()]; };
    // The corner farthest from each side; while it moves on, its distances to both ends of the side are looked at.
    std::size_t far = 1;
    for (std::size_t i = 0; i < p.size(); ++i) {
        consider(at(i), at(far), best);
        while (turns_left(at(i), at(i + 1), at(far), at(far + 1))) {
            far = (far + 1) % p.size();
            consider(at(i), at(far), best);
        }
        consider(at(i + 1), at(far), best);
        // A side parallel to this one: both its ends are as far.
        consider(at(i), at(far + 1), best);
        consider(at(i + 1), at(far + 1), best);
    }
    return best;
}

// Over pairs of the hull's corners.
Result<Diameter<glm::dvec3>> spatial_diameter(std::span<const glm::dvec3> points) {
    const auto hull = convex_hull(points);
    if (!hull) return hull.error();
    Aabb box;
    for (const std::uint32_t v : hull->vertices) box.include(points[v]);
    const glm::dvec3 middle = box.min + 0.5 * (box.max - box.min);
    struct Corner {
        glm::dvec3 point;
        double distance;  // from the middle
    };
    Vector<Corner> corners;
    corners.reserve(hull->vertices.size());
    for (const std::uint32_t v : hull->vertices) corners.push_back({points[v], glm::distance(points[v], middle)});
    std::stable_sort(corners.begin(), corners.end(),
                     [](const Corner& a, const Corner& b) { return a.distance > b.distance; });
    Diameter<glm::dvec3> best{0.0, corners[0].point, corners[0].point};
    for (std::size_t i = 0; i < corners.size(); ++i)
        for (std::size_t j = i + 1; j < corners.size(); ++j) {
            if (corners[i].distance + corners[j].distance < best.length) break;
            consider(corners[i].point, corners[j].point, best);
        }
    return best;
}

}  // namespace

Result<Diameter<glm::dvec2>> diameter(std::span<const glm::dvec2> points) {
    double largest = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double size = std::max(std::abs(points[i].x), std::abs(points[i].y));
        if (!(size <= kMaxCoordinate) || std::isnan(points[i].y))
            return fail(std::isfinite(points[i].x) && std::isfinite(points[i].y) ? ErrorCode::out_of_range
                                                                                 : ErrorCode::non_finite,
                        i, {"diameter: point ", i, " is NaN, infinite or beyond 1e30"});
        largest = std::max(largest, size);
    }
    if (largest < kTiny && largest > 0.0) return by_larger_points(points, largest, planar_diameter);
    return planar_diameter(points);
}

Result<Diameter<glm::dvec3>> diameter(std::span<const glm::dvec3> points) {
    double largest = 0.0;
    for (const glm::dvec3& p : points) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    // NaN is left to the hull, which names it.
    if (largest < kTiny && largest > 0.0) return by_larger_points(points, largest, spatial_diameter);
    return spatial_diameter(points);
}

}  // namespace crofton::study
