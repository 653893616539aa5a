// The same vocabulary in the plane: area and perimeter say all that a uniformly random query can see of a convex
// figure.
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

[[nodiscard]] PlanarMeasures of_disc(double radius);
[[nodiscard]] PlanarMeasures of_rectangle(double a, double b);
[[nodiscard]] PlanarMeasures of_planar_segment(double length);
// The polygon's points in counter-clockwise order; convexity is the caller's promise. One point or two are a point, a
// segment.
[[nodiscard]] PlanarMeasures of_convex_polygon(std::span<const glm::dvec2> points);

// The convex hull's corners, counter-clockwise from the lowest of the leftmost points, none within a segment of two
// others (Andrew's monotone chain). One corner where all points are equal, two where all are collinear. Errors: no
// points (empty); a NaN or infinite coordinate, by its index.
[[nodiscard]] Result<Vector<glm::dvec2>> convex_hull(std::span<const glm::dvec2> points);

// Blaschke's formula: the measure of motions of the plane under which B hits K, A_B + A_K + L_B·L_K/2π (rotations
// normalised to 1).
[[nodiscard]] double kinematic_measure(const PlanarMeasures& b, const PlanarMeasures& k);

// Crofton: the measure of the lines (without direction) that hit a convex figure is its perimeter.
[[nodiscard]] inline double measure_of_lines(const PlanarMeasures& k) {
    return k.perimeter;
}

}  // namespace crofton::measure
