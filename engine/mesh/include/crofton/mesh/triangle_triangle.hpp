// SPDX-License-Identifier: MIT
// Do two triangles meet? Exactly, whatever their shape.
#pragma once
#include <crofton/geometry/triangle.hpp>

namespace crofton::mesh {

// True iff the closed convex hulls of the three points of each share a point. Coplanar triangles and those that are
// segments or points are answered like all others. Signs come from a double filter with a proven bound, then from exact
// arithmetic. Exact while coordinates are 0 or have magnitudes in [1e-70, 1e70]; NaN meets nothing.
[[nodiscard]] bool intersects(const Triangle& a, const Triangle& b);

struct SegmentOfContact {
    glm::dvec3 begin{0.0}, end{0.0};
};
// Where two triangles that meet do so: the ends of their common segment (equal for a point; for coplanar triangles the
// ends of a longest diagonal of their common polygon, at most). Rounded to double.
[[nodiscard]] SegmentOfContact contact_segment(const Triangle& a, const Triangle& b);

}  // namespace crofton::mesh
