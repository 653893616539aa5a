// SPDX-License-Identifier: MIT
// Finds the best rectangle and the least disc around points of the plane.
#include <algorithm>
#include <cmath>
#include <crofton/core/recovery.hpp>
#include <crofton/fit/fit.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/measure/measure.hpp>
#include <glm/geometric.hpp>
#include <string>

#include "planar_points.hpp"
#include "rounding.hpp"
#include "search/calipers.hpp"

namespace crofton::fit {
namespace {

// The rectangle along `axis` around the points. dot(axis, p − c) rounds each difference, product and sum once: the
// error is less than 4 units of Σ|axis_i d_i|, and 5 are added.
Rectangle around(std::span<const glm::dvec2> points, const glm::dvec2& axis) {
    const glm::dvec2 axes[2] = {axis, {-axis.y, axis.x}};
    const glm::dvec2 first = points[0];
    Rectangle rectangle;
    rectangle.axis = axis;
    glm::dvec2 middle;
    for (int k = 0; k < 2; ++k) {
        double low = 0.0, high = 0.0;
        for (const glm::dvec2& p : points) {
            const double t = glm::dot(axes[k], p - first);
            low = std::min(low, t);
            high = std::max(high, t);
        }
        middle[k] = 0.5 * (low + high);
    }
    rectangle.center = first + axes[0] * middle.x + axes[1] * middle.y;
    for (int k = 0; k < 2; ++k)
        for (const glm::dvec2& p : points) {
            const glm::dvec2 d = p - rectangle.center;
            const double x = axes[k].x * d.x, y = axes[k].y * d.y;
            const double half = std::abs(x + y) + 5.0 * kUnit * (std::abs(x) + std::abs(y));
            rectangle.half_extents[k] = std::max(rectangle.half_extents[k], half);
        }
    return rectangle;
}

Disc through(const glm::dvec2& a, const glm::dvec2& b) {
    return {0.5 * (a + b), 0.5 * glm::distance(a, b)};
}

Disc through(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    const glm::dvec2 p = b - a, q = c - a;
    const double twice = 2.0 * (p.x * q.y - p.y * q.x);
    if (twice == 0.0) {
        // Collinear: the longest of the three segments.
        Disc longest = through(a, b);
        for (const Disc& other : {through(b, c), through(c, a)})
            if (other.radius > longest.radius) longest = other;
        return longest;
    }
    const double pp = glm::dot(p, p), qq = glm::dot(q, q);
    const glm::dvec2 center = glm::dvec2(q.y * pp - p.y * qq, p.x * qq - q.x * pp) / twice;
    return {a + center, glm::length(center)};
}

}  // namespace

Result<void> check_planar(std::span<const glm::dvec2> points) {
    if (points.empty()) return fail(ErrorCode::empty, kNoItem, "fit: no points");
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::dvec2 p = points[i];
        if (!std::isfinite(p.x) || !std::isfinite(p.y))
            return fail(ErrorCode::non_finite, i, {"fit: point ", i, " is NaN or infinite"});
        if (std::max(std::abs(p.x), std::abs(p.y)) > kMaxCoordinate)
            return fail(ErrorCode::out_of_range, i, {"fit: point ", i, " exceeds 1e30"});
    }
    return {};
}

Result<Rectangle> minimal_rectangle(std::span<const glm::dvec2> points, PlanarCriterion criterion) {
    return detail::recover([&]() -> Result<Rectangle> {
        if (auto valid = check_planar(points); !valid) return valid.error();
        const auto hull = measure::convex_hull(points);
        if (!hull) return hull.error();
        return minimal_rectangle_of_convex(*hull, criterion);
    });
}

Result<Rectangle> minimal_rectangle_of_convex(std::span<const glm::dvec2> polygon, PlanarCriterion criterion) {
    return detail::recover([&]() -> Result<Rectangle> {
        if (auto valid = check_planar(polygon); !valid) return valid.error();
        const bool by_area = criterion == PlanarCriterion::area;
        const Calipers best = minimal_rectangle(polygon, by_area ? 1.0 : 0.0, by_area ? 0.0 : 1.0);
        return around(polygon, best.direction);
    });
}

Result<Disc> minimal_disc(std::span<const glm::dvec2> points) {
    return detail::recover([&]() -> Result<Disc> {
        if (auto valid = check_planar(points); !valid) return valid.error();
        auto hull = measure::convex_hull(points);
        if (!hull) return hull.error();
        Vector<glm::dvec2>& corners = *hull;
        // A fixed shuffle suffices: the order around the hull is the bad case.
        std::uint64_t state = 0x9e3779b97f4a7c15u;
        for (std::size_t i = corners.size(); i > 1; --i) {
            state = state * 6364136223846793005u + 1442695040888963407u;
            std::swap(corners[i - 1], corners[(state >> 33) % i]);
        }
        // Work near the origin, so that squares do not lose what the coordinates hold.
        const glm::dvec2 origin = corners[0];
        for (glm::dvec2& p : corners) p -= origin;
        Disc disc;
        const auto outside = [&](const glm::dvec2& p) {
            return glm::distance(p, disc.center) > disc.radius * (1.0 + 1e-14);
        };
        for (std::size_t i = 1; i < corners.size(); ++i) {
            if (!outside(corners[i])) continue;
            disc = {corners[i], 0.0};
            for (std::size_t j = 0; j < i; ++j) {
                if (!outside(corners[j])) continue;
                disc = through(corners[i], corners[j]);
                for (std::size_t k = 0; k < j; ++k)
                    if (outside(corners[k])) disc = through(corners[i], corners[j], corners[k]);
            }
        }
        disc.center += origin;
        disc.radius = 0.0;
        // Differences, squares, sum and root round by less than 4 units together.
        for (const glm::dvec2& p : points)
            disc.radius = std::max(disc.radius, glm::distance(p, disc.center) * (1.0 + 5.0 * kUnit));
        return disc;
    });
}

}  // namespace crofton::fit
