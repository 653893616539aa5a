// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/geometry/finite.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/geometry/predicates.hpp>
#include <crofton/geometry/trigonometry.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/k_dop.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <string>

#include "k_dop_search.hpp"

namespace crofton::study {
namespace {

// All points where three faces meet and no other cuts off.
void find_corners(KDop& dop) {
    double size = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < dop.low.size(); ++i) {
        size = std::max(size, dop.high[i] - dop.low[i]);
        largest = std::max({largest, std::abs(dop.low[i]), std::abs(dop.high[i])});
    }
    const std::size_t n = dop.directions.size();
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = i + 1; j < n; ++j)
            for (std::size_t k = j + 1; k < n; ++k) {
                const glm::dmat3 rows =
                    glm::transpose(glm::dmat3(dop.directions[i], dop.directions[j], dop.directions[k]));
                const double determinant = std::abs(glm::determinant(rows));
                if (determinant < 1e-9) continue;
                // Far from the origin the offsets' own rounding counts, and more where the three faces are nearly
                // parallel to a line.
                const double tolerance = 1e-10 * size + 1e-15 * largest / determinant;
                const glm::dmat3 inverse = glm::inverse(rows);
                for (unsigned side = 0; side < 8; ++side) {
                    const glm::dvec3 p =
                        inverse * glm::dvec3(side & 1 ? dop.high[i] : dop.low[i], side & 2 ? dop.high[j] : dop.low[j],
                                             side & 4 ? dop.high[k] : dop.low[k]);
                    bool inside = true;
                    for (std::size_t m = 0; m < n && inside; ++m) {
                        const double at = glm::dot(dop.directions[m], p);
                        inside = at >= dop.low[m] - tolerance && at <= dop.high[m] + tolerance;
                    }
                    const bool known = std::any_of(dop.corners.begin(), dop.corners.end(), [&](const glm::dvec3& q) {
                        return glm::distance(p, q) <= tolerance;
                    });
                    if (inside && !known) dop.corners.push_back(p);
                }
            }
}

glm::dmat3 turned(const glm::dmat3& axes, const glm::dvec3& by) {
    glm::dmat3 result;
    for (int k = 0; k < 3; ++k) result[k] = axes[k] + glm::cross(by, axes[k]);
    result[0] = glm::normalize(result[0]);
    result[1] = glm::normalize(result[1] - glm::dot(result[0], result[1]) * result[0]);
    result[2] = glm::cross(result[0], result[1]);
    return result;
}

bool contains(const convex::Hull& hull, std::span<const glm::dvec3> points) {
    const auto indices = hull.triangles();
    const auto corner = [&](std::size_t i) { return glm::dvec3(hull.vertices()[indices[i]]); };
    for (std::size_t t = 0; t < indices.size(); t += 3)
        for (const glm::dvec3& p : points)
            if (orientation(corner(t), corner(t + 1), corner(t + 2), p) < 0) return false;
    return true;
}

}  // namespace

Result<Vector<glm::dvec3>> k_dop_directions(std::uint32_t k) {
    Vector<glm::dvec3> directions = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    if (k != 6 && k != 14 && k != 18 && k != 26)
        return fail(ErrorCode::invalid_argument, kNoItem, {"k-DOP: k must be 6, 14, 18 or 26, not ", k});
    if (k == 14 || k == 26)
        for (const double y : {1.0, -1.0})
            for (const double z : {1.0, -1.0}) directions.push_back(glm::dvec3(1.0, y, z) / std::sqrt(3.0));
    if (k == 18 || k == 26)
        for (const double sign : {1.0, -1.0})
            for (const glm::dvec3& d : {glm::dvec3(1, sign, 0), glm::dvec3(0, 1, sign), glm::dvec3(sign, 0, 1)})
                directions.push_back(d / std::sqrt(2.0));
    return directions;
}

Result<KDop> k_dop_around(std::span<const glm::dvec3> points, std::span<const glm::dvec3> directions) {
    if (points.empty()) return fail(ErrorCode::empty, kNoItem, "k-DOP: no points");
    if (directions.size() > 64) return fail(ErrorCode::out_of_range, kNoItem, "k-DOP: more than 64 directions");
    for (std::size_t i = 0; i < points.size(); ++i)
        if (!std::isfinite(points[i].x) || !std::isfinite(points[i].y) || !std::isfinite(points[i].z))
            return fail(ErrorCode::non_finite, i, {"k-DOP: point ", i, " is NaN or infinite"});
    KDop dop;
    for (std::size_t i = 0; i < directions.size(); ++i) {
        const double length = glm::length(directions[i]);
        if (!(length > 0.0) || !std::isfinite(length))
            return fail(ErrorCode::invalid_argument, i, {"k-DOP: direction ", i, " is zero or not finite"});
        dop.directions.push_back(directions[i] / length);
    }
    double widest = 0.0;
    for (const glm::dvec3& a : dop.directions)
        for (const glm::dvec3& b : dop.directions)
            for (const glm::dvec3& c : dop.directions)
                widest = std::max(widest, std::abs(glm::dot(a, glm::cross(b, c))));
    if (widest < 1e-9) return fail(ErrorCode::degenerate, kNoItem, "k-DOP: all directions lie in a plane");
    for (const glm::dvec3& d : dop.directions) {
        double low = kInfinity, high = -kInfinity;
        for (const glm::dvec3& p : points) low = std::min(low, glm::dot(d, p)), high = std::max(high, glm::dot(d, p));
        dop.low.push_back(low), dop.high.push_back(high);
    }
    find_corners(dop);
    return dop;
}

Result<BestKDop> best_k_dop(std::span<const glm::dvec3> points, std::span<const glm::dvec3> directions,
                            const measure::Criterion& criterion, const BestKDopOptions& options) {
    if (auto valid = measure::validate(criterion); !valid) return valid.error();
    if (!(options.tolerance > 0.0 && options.tolerance < 1.0))
        return fail(ErrorCode::invalid_argument, kNoItem, "k-DOP: `tolerance` must lie in (0, 1)");
    const auto hull = convex_hull(points);
    if (!hull) return hull.error();
    if (hull->rank < 3) return fail(ErrorCode::degenerate, kNoItem, "k-DOP: the points lie in a plane");
    Vector<glm::dvec3> corners;
    for (const std::uint32_t v : hull->vertices) corners.push_back(points[v]);
    const auto own = measure::intrinsic_volumes_of_hull(corners);
    if (!own) return own.error();
    BestKDop best;
    best.value = kInfinity;
    const auto value_at = [&](const glm::dmat3& rotation, KDop& dop) {
        Vector<glm::dvec3> turned_directions;
        for (const glm::dvec3& d : directions) turned_directions.push_back(rotation * d);
        auto around = k_dop_around(corners, turned_directions);
        if (!around) return kInfinity;
        const auto volumes = measure::intrinsic_volumes_of_hull(around->corners);
        if (!volumes) return kInfinity;
        dop = std::move(*around);
        return criterion(*volumes);
    };
    if (auto checked = k_dop_around(corners, directions); !checked) return checked.error();
    KDop dop;
    constexpr int kStarts = 6;
    for (int start = 0; start < kStarts; ++start) {
        sampling::Random random(17, static_cast<std::uint64_t>(start));
        glm::dmat3 at = start == 0 ? glm::dmat3(1.0) : sampling::rotation(random.point<3>());
        double value = value_at(at, dop);
        if (value < best.value) best.value = value, best.bound = dop, best.rotation = at;
        for (double step = 0.3; step > 2e-3; step *= 0.6)
            for (int tries = 0; tries < 4; ++tries) {
                const glm::dvec3 by = step * sampling::ball_point(random.point<3>());
                const glm::dmat3 next = turned(at, by);
                const double there = value_at(next, dop);
                if (!(there < value)) continue;
                at = next, value = there;
                if (value < best.value) best.value = value, best.bound = dop, best.rotation = at;
            }
    }
    glm::dvec3 middle(0.0);
    for (const glm::dvec3& p : corners) middle += p / static_cast<double>(corners.size());
    Vector<glm::dvec3> around_middle;
    for (const glm::dvec3& p : corners) around_middle.push_back(p - middle);
    Vector<glm::dvec3> units;
    for (const glm::dvec3& d : directions) units.push_back(glm::normalize(d));
    const KDopSearch found =
        search_rotations(around_middle, units, criterion, best.value, options.tolerance, options.max_cells);
    if (const double value = value_at(found.rotation, dop); value < best.value)
        best.value = value, best.bound = dop, best.rotation = found.rotation;
    // Every bound contains the hull.
    best.lower_bound = std::min(best.value, std::max(criterion(*own), found.lower_bound));
    best.cells = found.cells;
    return best;
}

Result<convex::Hull> hull_around(const KDop& dop, std::span<const glm::dvec3> points) {
    if (points.empty()) return fail(ErrorCode::empty, kNoItem, "k-DOP: no points");
    for (std::size_t i = 0; i < points.size(); ++i)
        if (!is_finite(points[i])) return fail(ErrorCode::non_finite, i, "k-DOP: a point is NaN or infinite");
    double size = 0.0;
    for (std::size_t i = 0; i < dop.low.size(); ++i)
        size = std::max({size, std::abs(dop.low[i]), std::abs(dop.high[i])});
    for (double pad = 0x1p-22 * size;; pad *= 2.0) {
        KDop grown{dop.directions, dop.low, dop.high, {}};
        for (double& low : grown.low) low -= pad;
        for (double& high : grown.high) high += pad;
        find_corners(grown);
        auto hull = convex::Hull::build(Vector<glm::vec3>(grown.corners.begin(), grown.corners.end()));
        if (!hull || contains(*hull, points)) return hull;
        if (!(pad < size)) return fail(ErrorCode::invalid_argument, kNoItem, "k-DOP: it does not contain the points");
    }
}

}  // namespace crofton::study
