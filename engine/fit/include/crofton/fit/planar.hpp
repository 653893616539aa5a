// SPDX-License-Identifier: MIT
// In the plane: the best rectangle and the smallest disc around points.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/geometry/disc.hpp>
#include <crofton/geometry/rectangle.hpp>
#include <cstdint>
#include <span>

namespace crofton::fit {

enum class PlanarCriterion : std::uint8_t {
    perimeter,  // the measure of the lines that meet the rectangle
    area,       // the measure of the points in it
};

// The best of all rectangles, by rotating calipers: one side holds an edge of the hull (theory.md section 3). O(n log
// n). Contains every point, and is larger than the best by rounding only. Errors: no points; a coordinate that is NaN,
// infinite or beyond 1e30 in magnitude, by index.
[[nodiscard]] Result<Rectangle> minimal_rectangle(std::span<const glm::dvec2> points, PlanarCriterion criterion);

// The same in O(n) around a convex polygon given by its corners in counter-clockwise order, none twice. One or two
// corners are a point or a segment. If the polygon is not convex, the rectangle contains every point but may not be
// best.
[[nodiscard]] Result<Rectangle> minimal_rectangle_of_convex(std::span<const glm::dvec2> polygon,
                                                            PlanarCriterion criterion);

// The smallest disc. Contains every point, and is larger than the smallest by rounding only. Errors as above.
// O(n log n) for the hull, then expected linear in its corners (Welzl 1991).
[[nodiscard]] Result<Disc> minimal_disc(std::span<const glm::dvec2> points);

}  // namespace crofton::fit
