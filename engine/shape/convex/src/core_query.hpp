// SPDX-License-Identifier: MIT
// Distance and depth of two cores, exact where double is not enough. All queries use it.
#pragma once
#include "epa.hpp"
#include "gjk.hpp"

namespace crofton::convex {

// nearest_points, where needed followed by exact arithmetic: of polytopes `meeting` is never unknown, and unless the
// search was cut short by `near` or `far` the bounds are closer than 2 · `accuracy` of the size.
[[nodiscard]] Nearest core_distance(const Pair& pair, const PairCache* cache, double near, double far,
                                    double accuracy = 0.5e-10);

// Whether the shapes meet: what all queries tell, so that they agree. `core` is of any search whose `near` is at most,
// and whose `far` at least the rounding, by `doubt`. Where its bounds are nearer to the rounding than that, one search
// decides that depends on the two placed shapes alone, not on their order, a cache or the query; it replaces `core`.
[[nodiscard]] bool settle(const Pair& pair, Nearest& core);

// Of cores apart: finds the nearest points, and the normal, anew in exact arithmetic where the way between them is off
// `normal` by more than 1e-10 of the size. For polytopes.
void align_points(const Pair& pair, const glm::dvec3& normal, Nearest& found);

// What `distance` tells of it.
[[nodiscard]] Distance distance_of(const Pair& pair, Nearest core);

// Of cores that meet: of polytopes the bounds are closer than 1e-9 of the size.
[[nodiscard]] Depth core_depth(const Pair& pair, const Simplex& start);

// A half-space and another shape.
struct HalfSpaceGap {
    double gap = 0.0, error = 0.0;  // of the core from the boundary, negative within; off by at most `error`
    glm::dvec3 outward{0.0};        // unit normal of the boundary
    glm::dvec3 deepest{0.0};        // point of the core, in the world
};
[[nodiscard]] HalfSpaceGap half_space_gap(const ShapeAtPose& half_space, const ShapeAtPose& shape);

// Whether they meet: exact for polytopes without rounding.
[[nodiscard]] bool half_space_meets(const ShapeAtPose& half_space, const ShapeAtPose& shape);
// How far apart two half-spaces are, with the normal from the first; nothing if they meet.
[[nodiscard]] double gap_of_half_spaces(const ShapeAtPose& a, const ShapeAtPose& b, glm::dvec3& normal);

[[nodiscard]] inline bool is_half_space(const ShapeAtPose& shape) {
    return shape.shape.kind() == Kind::half_space;
}
// A half-space, or a compound that holds one.
[[nodiscard]] inline bool is_unbounded(const ShapeAtPose& shape) {
    return !shape.shape.is_bounded();
}

}  // namespace crofton::convex
