// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/core/recovery.hpp>
#include <crofton/geometry/predicates.hpp>
#include <crofton/measure/measure.hpp>
#include <glm/geometric.hpp>
#include <numbers>

namespace crofton::measure {
namespace {

double cross(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

bool before(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x != b.x ? a.x < b.x : a.y < b.y;
}

}  // namespace

using std::numbers::pi;

PlanarMeasures planar_measures_of_disc(double radius) {
    return {pi * radius * radius, 2.0 * pi * radius};
}
PlanarMeasures planar_measures_of_rectangle(double a, double b) {
    return {a * b, 2.0 * (a + b)};
}
PlanarMeasures planar_measures_of_segment(double length) {
    return {0.0, 2.0 * length};
}

PlanarMeasures planar_measures_of_convex_polygon(std::span<const glm::dvec2> points) {
    PlanarMeasures result;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::dvec2& a = points[i];
        const glm::dvec2& b = points[i + 1 < points.size() ? i + 1 : 0];
        result.area += 0.5 * cross(a - points[0], b - points[0]);
        result.perimeter += glm::length(b - a);
    }
    return result;
}

Result<Vector<glm::dvec2>> convex_hull(std::span<const glm::dvec2> points) {
    return detail::recover([&]() -> Result<Vector<glm::dvec2>> {
        if (points.empty()) return fail(ErrorCode::empty, kNoItem, "convex hull: no points");
        for (std::size_t i = 0; i < points.size(); ++i)
            if (!std::isfinite(points[i].x) || !std::isfinite(points[i].y))
                return fail(ErrorCode::non_finite, i, "convex hull: a point is NaN or infinite");
        Vector<glm::dvec2> sorted(points.begin(), points.end());
        std::sort(sorted.begin(), sorted.end(), before);
        sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
        if (sorted.size() < 3) return sorted;
        Vector<glm::dvec2> hull;
        hull.reserve(sorted.size() + 1);
        const auto add = [&](const glm::dvec2& p, std::size_t floor) {
            while (hull.size() >= floor + 2 && orientation(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
            hull.push_back(p);
        };
        for (const glm::dvec2& p : sorted) add(p, 0);
        const std::size_t lower = hull.size() - 1;
        for (std::size_t i = sorted.size() - 1; i-- > 0;) add(sorted[i], lower);
        hull.pop_back();
        return hull;
    });
}

double kinematic_measure(const PlanarMeasures& b, const PlanarMeasures& k) {
    return b.area + k.area + b.perimeter * k.perimeter / (2.0 * pi);
}

}  // namespace crofton::measure
