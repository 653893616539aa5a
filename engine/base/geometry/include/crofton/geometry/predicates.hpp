// SPDX-License-Identifier: MIT
// Exact signs of determinants: a filter with Shewchuk's proven bounds decides most, expansions decide the rest.
#pragma once
#include <cmath>
#include <crofton/core/version.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace crofton {

// Inputs must be finite. Results are exact if all coordinates are 0 or have magnitudes in [1e-70, 1e70], for in_circle
// in [1e-65, 1e70]. Products of three or four differences then stay within double, down to the last place of the
// smallest.

namespace detail {

// Error bounds of the filters, relative to the sum of the absolute products ("permanent"), with u = 2^-53. Source:
// Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates" (1997), bounds A of
// figures 21 and 24.
inline constexpr double kRounding = 0x1p-53;
inline constexpr double kOrientationBound = (3.0 + 16.0 * kRounding) * kRounding;
inline constexpr double kInCircleBound = (10.0 + 96.0 * kRounding) * kRounding;

[[nodiscard]] inline int sign_of(double value) {
    return (value > 0.0) - (value < 0.0);
}
[[nodiscard]] int orientation_exact(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c);
[[nodiscard]] int in_circle_exact(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& d);

}  // namespace detail

// Returns > 0 if a, b, c turn counter-clockwise, < 0 if clockwise, 0 if they are collinear.
[[nodiscard]] inline int orientation(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    const double left = (a.x - c.x) * (b.y - c.y);
    const double right = (a.y - c.y) * (b.x - c.x);
    const double determinant = left - right;
    // With both products 0 the bound is 0 and so, exactly, is the determinant.
    if (std::fabs(determinant) >= detail::kOrientationBound * (std::fabs(left) + std::fabs(right))) {
        return detail::sign_of(determinant);
    }
    return detail::orientation_exact(a, b, c);
}

// Returns > 0 if d lies inside the circle through the counter-clockwise a, b, c, < 0 if outside, 0 if on it.
[[nodiscard]] inline int in_circle(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& d) {
    const double ax = a.x - d.x, ay = a.y - d.y, bx = b.x - d.x, by = b.y - d.y, cx = c.x - d.x, cy = c.y - d.y;
    const double bxcy = bx * cy, cxby = cx * by, cxay = cx * ay, axcy = ax * cy, axby = ax * by, bxay = bx * ay;
    const double a_lift = ax * ax + ay * ay, b_lift = bx * bx + by * by, c_lift = cx * cx + cy * cy;
    const double determinant = a_lift * (bxcy - cxby) + b_lift * (cxay - axcy) + c_lift * (axby - bxay);
    const double permanent = (std::fabs(bxcy) + std::fabs(cxby)) * a_lift +
                             (std::fabs(cxay) + std::fabs(axcy)) * b_lift +
                             (std::fabs(axby) + std::fabs(bxay)) * c_lift;
    if (std::fabs(determinant) >= detail::kInCircleBound * permanent) return detail::sign_of(determinant);
    return detail::in_circle_exact(a, b, c, d);
}

// Returns > 0 if d lies below the plane through a, b, c, < 0 if above it, 0 if on it. "Above" is the side from which a,
// b, c turn counter-clockwise. This is the sign of det(a − d, b − d, c − d), as in Shewchuk's orient3d.
[[nodiscard]] int orientation(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d);

}  // namespace crofton
