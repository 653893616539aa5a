// SPDX-License-Identifier: MIT
// Queries of shapes with parts against any shape. Here a has parts.
#pragma once
#include "parts.hpp"

namespace crofton::convex {

[[nodiscard]] bool parts_meet(const ShapeAtPose& a, const ShapeAtPose& b);
// Infinite if that is not less than `limit`.
[[nodiscard]] Distance distance_of_parts(const ShapeAtPose& a, const ShapeAtPose& b, double limit);
[[nodiscard]] Penetration penetration_of_parts(const ShapeAtPose& a, const ShapeAtPose& b);

// `distance` of two convex shapes; above `far` any lower bound above it will do.
[[nodiscard]] Distance near_distance(const ShapeAtPose& a, const ShapeAtPose& b, double far);

// Calls visit for the parts of a that may be within `margin` of b.
bool visit_parts_near(const ShapeAtPose& a, const ShapeAtPose& b, double margin, PartVisitor visit);
// The same, with the triangles of surfaces by themselves.
bool visit_parts_near(const ShapeAtPose& a, const ShapeAtPose& b, double margin, PartVisitor convex,
                      TriangleVisitor triangle);

[[nodiscard]] inline Distance flipped(Distance d) {
    std::swap(d.on_a, d.on_b);
    std::swap(d.part_a, d.part_b);
    d.normal = -d.normal;
    return d;
}
[[nodiscard]] inline Penetration flipped(Penetration p) {
    std::swap(p.on_a, p.on_b);
    std::swap(p.part_a, p.part_b);
    p.normal = -p.normal;
    return p;
}

}  // namespace crofton::convex
