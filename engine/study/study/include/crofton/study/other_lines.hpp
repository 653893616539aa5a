// SPDX-License-Identifier: MIT
// Two more correct ways to draw uniform lines, from section 6 of the paper, for tests and teaching. Those of
// sampling/sampling.hpp cover all lines of a region and cost less.
#pragma once
#include <array>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/sampling/sampling.hpp>
#include <glm/vec2.hpp>

namespace crofton::study {

struct WeightedLine {
    Line line;
    double weight = 0.0;
};

// Returns the line through a uniform point of the box's lower face across `axis` and one of the upper face, at distance
// r.
//
// For faces of area A at distance d the weight is A²·d²/r⁴. The mean of weight · [event] is the measure of the lines
// that cross both faces and are in the event. Without the weight such lines are not uniform: there are too many long
// ones. Requires a box with positive extents and axis < 3.
[[nodiscard]] WeightedLine line_through_opposite_faces(const Aabb& box, int axis, const std::array<double, 4>& u);

// Appends a bundle like that of sampling::append_line_bundle, but with parallelograms as cells. They are spanned by
// `first` and `second` in the plane perpendicular to the direction, at a random place and rotation. Each cell has one
// uniform line. A surface of area S in the sphere is crossed S/(2·|first × second|) times on average. Requires cells of
// positive area, and at most 2^31 of them.
void append_parallelogram_bundle(const Sphere& sphere, const glm::dvec2& first, const glm::dvec2& second,
                                 sampling::Random& random, Vector<Line>& lines);

}  // namespace crofton::study
