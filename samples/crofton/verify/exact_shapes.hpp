// SPDX-License-Identifier: MIT
// Hulls, boxes and triangles where they stand, in numbers that are never rounded: whether two meet, and how deep.
#pragma once
#include <crofton/convex/query.hpp>
#include <oracle/polytopes.hpp>

namespace crofton::cli {

using oracle::ExactWay;

// Whether the shapes meet, b at the end of a way. The engine guesses planes and points, which are checked together with
// `normal` (from a to b); if none is a proof, all separating axes are tried.
[[nodiscard]] bool meet_exactly(const convex::ShapeAtPose& a, const convex::ShapeAtPose& b, const glm::dvec3& normal,
                                const ExactWay& way_of_b = {});

// Whether a plane across `normal` (from a to b) separates the shapes.
[[nodiscard]] bool is_parted_by(const convex::ShapeAtPose& a, const convex::ShapeAtPose& b, const glm::dvec3& normal);

// Whether the depth of two shapes that meet lies in [lower, upper]: by all faces of the difference body, found among
// all triples of its points. For shapes of few corners.
[[nodiscard]] bool depth_lies_between(const convex::ShapeAtPose& a, const convex::ShapeAtPose& b, double lower,
                                      double upper);

}  // namespace crofton::cli
