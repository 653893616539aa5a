// SPDX-License-Identifier: MIT
// The plane: area and perimeter say how often uniformly random queries meet a convex figure.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <glm/vec2.hpp>
#include <span>

namespace crofton::measure {

// A segment's perimeter is twice its length: the limit of thin rectangles.
struct PlanarMeasures {
    double area = 0.0;
    double perimeter = 0.0;
};

[[nodiscard]] PlanarMeasures planar_measures_of_disc(double radius);
[[nodiscard]] PlanarMeasures planar_measures_of_rectangle(double a, double b);
[[nodiscard]] PlanarMeasures planar_measures_of_segment(double length);
// Points in counter-clockwise order; one or two are a point or a segment. Convexity is not checked.
[[nodiscard]] PlanarMeasures planar_measures_of_convex_polygon(std::span<const glm::dvec2> points);

// The convex hull's corners, counter-clockwise from the lowest of the leftmost points, none within a segment of two
// others (Andrew's monotone chain). One corner where all points are equal, two where all are collinear. Errors: no
// points (empty); a NaN or infinite coordinate, by its index.
[[nodiscard]] Result<Vector<glm::dvec2>> convex_hull(std::span<const glm::dvec2> points);

// The measure of the motions of the plane under which B meets K, by Blaschke's formula: A_B + A_K + L_B·L_K/2π.
// Rotations have measure 1, translations their area.
[[nodiscard]] double kinematic_measure(const PlanarMeasures& b, const PlanarMeasures& k);

// The measure of the lines, without direction, that hit a convex figure: its perimeter (Crofton).
[[nodiscard]] inline double measure_of_lines(const PlanarMeasures& k) {
    return k.perimeter;
}

}  // namespace crofton::measure
