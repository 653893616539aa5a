// SPDX-License-Identifier: MIT
// The measures of the planes and lines in space that hit all of n convex bodies (docs/theory.md (4) and (5)), by
// quadrature with a proven error bound.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/study/convex_body.hpp>
#include <cstdint>
#include <span>

namespace crofton::study {

// An interval: the exact value lies within `error` of `value` (apart from rounding, about 1e-13 of the coordinates).
struct Enclosure {
    double value = 0.0;
    double error = 0.0;
    std::uint64_t cells = 0;
};

struct QuadratureOptions {
    double tolerance = 1e-4;          // stop when error ≤ tolerance · value …
    std::uint64_t max_cells = 20000;  // … or after this many cells of directions, each looked at once
};

// Computes (4), normalised so that one body gives its M: the integral over the directions of a half sphere of max(0,
// min_i h_i(n) + min_i h_i(−n)). For two bodies that overlap it is M₁ + M₂ − M_hull.
//
// The half sphere is cut into spherical triangles, the one with the widest bounds first. On each, support functions lie
// above a tangent and below the chord through the corners, because they are convex. Both are linear in n and integrated
// exactly. Error ∝ 1/cells or better. Errors: no bodies, a body without points, numbers that are NaN, infinite or
// beyond kMaxCoordinate, a negative radius; item = the body.
[[nodiscard]] Result<Enclosure> measure_of_planes_hitting_all(std::span<const ConvexBody> bodies,
                                                              const QuadratureOptions& options = {});

// Computes (5), normalised so that one body gives π·F/2 = measure_of_lines(F): the integral over a half sphere of the
// area common to the projections along n.
//
// On a triangle of directions every projection lies in the hull of the projections along the corners. It contains the
// middle one with each side moved inward by how far any point of it can move. Error ∝ 1/√cells only, so ask for 1e-2.
// `value` is the sum over the middle directions, clamped to the bounds, and is far better than they prove. Spheres are
// treated as polygons of 32 sides, inside and outside.
[[nodiscard]] Result<Enclosure> measure_of_lines_hitting_all(std::span<const ConvexBody> bodies,
                                                             const QuadratureOptions& options = {.tolerance = 2e-2});

// Compute Cauchy's formulas: F = (1/π) ∫ projected area over the sphere, and M = π × the mean width × 2.
[[nodiscard]] Result<Enclosure> cauchy_area(const ConvexBody& body,
                                            const QuadratureOptions& options = {.tolerance = 2e-2});
[[nodiscard]] Result<Enclosure> cauchy_mean_curvature(const ConvexBody& body, const QuadratureOptions& options = {});

}  // namespace crofton::study
