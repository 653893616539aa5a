// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/study/k_dop.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

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
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (const glm::dvec3& p : points) low = std::min(low, glm::dot(d, p)), high = std::max(high, glm::dot(d, p));
        dop.low.push_back(low), dop.high.push_back(high);
    }
    find_corners(dop);
    return dop;
}

}  // namespace crofton::study
