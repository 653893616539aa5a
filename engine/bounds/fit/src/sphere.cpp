// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/fit/fit.hpp>
#include <crofton/geometry/box.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <string>

#include "rounding.hpp"

namespace crofton::fit {
namespace {

constexpr double kGrown = 1.0 + 1e-12;

// The least sphere with all of up to four points on its surface: its centre c = p₀ + Σ t_k e_k solves
// 2 e_j · (c − p₀) = e_j², e_k = p_k − p₀, in the space that these span. Radius −1 where they are dependent.
Sphere through(std::span<const glm::dvec3> p) {
    const std::size_t n = p.size() - 1;
    std::array<std::array<double, 4>, 3> rows{};
    std::array<glm::dvec3, 3> edge{};
    for (std::size_t k = 0; k < n; ++k) edge[k] = p[k + 1] - p[0];
    for (std::size_t j = 0; j < n; ++j) {
        for (std::size_t k = 0; k < n; ++k) rows[j][k] = 2.0 * glm::dot(edge[j], edge[k]);
        rows[j][3] = glm::dot(edge[j], edge[j]);
    }
    for (std::size_t k = 0; k < n; ++k) {
        std::size_t pivot = k;
        for (std::size_t j = k + 1; j < n; ++j)
            if (std::abs(rows[j][k]) > std::abs(rows[pivot][k])) pivot = j;
        std::swap(rows[k], rows[pivot]);
        if (!(std::abs(rows[k][k]) > 1e-14 * glm::dot(edge[k], edge[k]))) return {p[0], -1.0};
        for (std::size_t j = 0; j < n; ++j) {
            if (j == k) continue;
            const double times = rows[j][k] / rows[k][k];
            for (std::size_t i = k; i < 4; ++i) rows[j][i] -= times * rows[k][i];
        }
    }
    glm::dvec3 to_center(0.0);
    for (std::size_t k = 0; k < n; ++k) to_center += rows[k][3] / rows[k][k] * edge[k];
    return {p[0] + to_center, glm::length(to_center)};
}

struct Support {
    std::array<glm::dvec3, 4> points{};
    std::size_t count = 0;
    [[nodiscard]] std::span<const glm::dvec3> view() const { return {points.data(), count}; }
};

// The least sphere around up to five points: of those through one to four of them that hold all, the smallest.
Sphere least(std::span<const glm::dvec3> points, Support& support) {
    Sphere best{points[0], std::numeric_limits<double>::infinity()};
    for (unsigned subset = 1; subset < 1u << points.size(); ++subset) {
        Support chosen;
        for (std::size_t k = 0; k < points.size(); ++k) {
            if ((subset >> k & 1u) == 0) continue;
            if (chosen.count < 4) chosen.points[chosen.count] = points[k];
            ++chosen.count;
        }
        if (chosen.count > 4) continue;
        const Sphere sphere = through(chosen.view());
        if (sphere.radius < 0.0 || sphere.radius >= best.radius) continue;
        const bool holds = std::all_of(points.begin(), points.end(), [&](const glm::dvec3& p) {
            return glm::distance(p, sphere.center) <= sphere.radius * kGrown;
        });
        if (holds) best = sphere, support = chosen;
    }
    return best;
}

}  // namespace

Result<Sphere> minimal_sphere(std::span<const glm::dvec3> points) {
    if (points.empty()) return fail(ErrorCode::empty, kNoItem, "minimal_sphere: no points");
    double size = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::dvec3 p = glm::abs(points[i]);
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
            return fail(ErrorCode::non_finite, i, {"fit: point ", i, " is NaN or infinite"});
        if (std::max({p.x, p.y, p.z}) > kMaxCoordinate)
            return fail(ErrorCode::out_of_range, i, {"fit: point ", i, " exceeds 1e30"});
        const glm::dvec3 d = glm::abs(points[i] - points[0]);
        size = std::max({size, d.x, d.y, d.z});
    }
    Sphere sphere{points[0], 0.0};
    if (size > 0.0) {
        // Relative to the first point and to the set's size.
        const glm::dvec3 origin = points[0];
        const auto local = [&](std::size_t i) { return (points[i] - origin) / size; };
        Support support;
        support.points[0] = glm::dvec3(0.0), support.count = 1;
        Sphere found{glm::dvec3(0.0), 0.0};
        // Each round the radius grows; where rounding stops it, what is left outside is rounding.
        for (double before = -1.0; found.radius > before;) {
            std::size_t farthest = 0;
            double distance = -1.0;
            for (std::size_t i = 0; i < points.size(); ++i)
                if (const double d = glm::distance(local(i), found.center); d > distance) distance = d, farthest = i;
            if (distance <= found.radius * kGrown) break;
            std::array<glm::dvec3, 5> candidates{};
            std::copy(support.points.begin(), support.points.begin() + static_cast<std::ptrdiff_t>(support.count),
                      candidates.begin());
            candidates[support.count] = local(farthest);
            Support next = support;
            const Sphere grown = least({candidates.data(), support.count + 1}, next);
            if (!std::isfinite(grown.radius)) break;
            before = found.radius;
            found = grown, support = next;
        }
        sphere.center = origin + size * found.center;
    }
    // Differences, squares, sum and root round by less than 4 units together.
    for (const glm::dvec3& p : points)
        sphere.radius = std::max(sphere.radius, glm::distance(p, sphere.center) * (1.0 + 5.0 * kUnit));
    return sphere;
}

}  // namespace crofton::fit
