// SPDX-License-Identifier: MIT
// Rotating calipers: the best rectangle around a convex polygon in linear time.
#pragma once
#include <cstddef>
#include <glm/vec2.hpp>
#include <span>

namespace crofton::fit {

// Sorts `points` and writes their convex hull to `hull` (room for points.size() + 1): counter-clockwise from the
// lexicographic minimum, without collinear points; returns its size, 1 or 2 for degenerate sets. Decided in rounded
// arithmetic: a point within a few ulps of the hull's boundary may be dropped or kept. (Andrew's monotone chain.)
std::size_t convex_hull(std::span<glm::dvec2> points, std::span<glm::dvec2> hull);

struct Calipers {
    glm::dvec2 direction{1.0, 0.0};  // unit, along `width`
    double width = 0.0, height = 0.0;
    double value = 0.0;
};

// The rectangle that minimises product_weight · width · height + sum_weight · (width + height) around a convex polygon
// as convex_hull makes it. One side is flush with an edge at the minimum (theory.md section 3), so only edges are
// tried.
[[nodiscard]] Calipers minimal_rectangle(std::span<const glm::dvec2> hull, double product_weight, double sum_weight);

}  // namespace crofton::fit
