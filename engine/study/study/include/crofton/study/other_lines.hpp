// SPDX-License-Identifier: MIT
// Two more right ways to draw uniform lines, from the paper's section 6: for tests and teaching. Those of
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

// Through a uniform point of the box's lower face across `axis` and one of the upper face, r apart. For faces of area A
// at distance d the weight is A²·d²/r⁴. The mean of weight · [event] is the measure of the lines that cross both faces
// and are in the event. Without the weight such lines are not uniform: long ones are too many. Requires a box with
// positive extents and axis < 3.
[[nodiscard]] WeightedLine line_through_opposite_faces(const Aabb& box, int axis, const std::array<double, 4>& u);

// A bundle as sampling::append_line_bundle draws it, but with parallelograms for cells. These are spanned by `first`
// and `second` in the plane across the direction, at a random place and turn. One uniform line in each cell. A surface
// of area S in the sphere expects S/(2·|first × second|) crossings. Requires cells of positive area, and at most 2^31
// of them.
void append_parallelogram_bundle(const Sphere& sphere, const glm::dvec2& first, const glm::dvec2& second,
                                 sampling::Random& random, Vector<Line>& lines);

}  // namespace crofton::study
