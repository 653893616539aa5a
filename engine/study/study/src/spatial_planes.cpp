// SPDX-License-Identifier: MIT
// Measures the planes that meet all of several bodies.
#include <crofton/geometry/finite.hpp>
#include <limits>
#include <numbers>

#include "direction_cells.hpp"

namespace crofton::study {

Result<void> validate_bodies(std::span<const ConvexBody> bodies) {
    if (bodies.empty()) return fail(ErrorCode::empty, kNoItem, "lines hitting all: no bodies");
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        if (bodies[i].points.empty()) return fail(ErrorCode::empty, i, "lines hitting all: a body without points");
        if (!(bodies[i].radius >= 0.0 && bodies[i].radius <= kMaxCoordinate))
            return fail(ErrorCode::invalid_argument, i, "lines hitting all: a radius is negative, NaN or beyond 1e30");
        for (const glm::dvec3& p : bodies[i].points)
            if (!is_in_range(p))
                return fail(is_finite(p) ? ErrorCode::out_of_range : ErrorCode::non_finite, i,
                            "lines hitting all: a point is NaN, infinite or beyond 1e30");
    }
    return {};
}

namespace {

// Bounds of min_i h_i at the three corners: `low` linear below it, `high` linear above it on the whole triangle.
struct LinearBounds {
    std::array<double, 3> low, high;
};

LinearBounds bound_least_support(std::span<const ConvexBody> bodies, const DirectionTriangle& corners, double sign) {
    const glm::dvec3 middle = sign * glm::normalize(corners[0] + corners[1] + corners[2]);
    LinearBounds result;
    result.low.fill(std::numeric_limits<double>::infinity());
    double best = std::numeric_limits<double>::infinity();
    for (const ConvexBody& body : bodies) {
        // h ≥ dot(p, n) for any point p of the body; the least of such functions is concave, so above its chord. h is
        // convex, so below its chord; of the bodies any one will do for the upper bound.
        const glm::dvec3 touched = support_point(body, middle);
        std::array<double, 3> values;
        double sum = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
            result.low[k] = std::min(result.low[k], glm::dot(touched, sign * corners[k]));
            sum += values[k] = support(body, sign * corners[k]);
        }
        if (sum < best) best = sum, result.high = values;
    }
    return result;
}

}  // namespace

Result<Enclosure> measure_of_planes_hitting_all(std::span<const ConvexBody> bodies, const QuadratureOptions& options) {
    if (auto valid = validate_bodies(bodies); !valid) return valid.error();
    return integrate_directions(options, [&](const DirectionTriangle& corners) {
        const auto weights = linear_weights(corners);
        const LinearBounds front = bound_least_support(bodies, corners, 1.0),
                           back = bound_least_support(bodies, corners, -1.0);
        CellBounds cell;
        bool positive = true;
        for (std::size_t k = 0; k < 3; ++k) {
            const double low = front.low[k] + back.low[k], high = front.high[k] + back.high[k];
            positive = positive && low >= 0.0;
            cell.low += weights[k] * low;
            cell.high += weights[k] * std::max(0.0, high);  // max(0, linear) is convex: below its chord
        }
        cell.low = positive ? cell.low : std::max(0.0, cell.low);
        cell.value = 0.5 * (cell.low + cell.high);
        return cell;
    });
}

Result<Enclosure> cauchy_mean_curvature(const ConvexBody& body, const QuadratureOptions& options) {
    return measure_of_planes_hitting_all({&body, 1}, options);
}

}  // namespace crofton::study
