// SPDX-License-Identifier: MIT
// Straight sides and edges of two shapes that lie along each other.
#pragma once
#include "gather.hpp"

namespace crofton::convex {

// A shape and its patch along the normal. Of a surface's triangle the patch alone: `shape` is null.
struct PatchOf {
    const ShapeAtPose* shape;
    const Patch& patch;
};

// Adds the ends of the stretch that two straight sides or edges have in common with which the shapes touch, where these
// are parallel within 2 degrees. Of a sharp edge: where they lie on each other. Returns false, and adds nothing, where
// there are none such, and where a shape touches with a face: that is clipped. `off_face`: it was, and the other's side
// passes outside of it, by no more than the normal is off. `normal` is from a to b, points are around `origin`, `size`
// is that of the pair.
bool gather_parallel_edges(const PatchOf& a, const PatchOf& b, const glm::dvec3& normal, const glm::dvec3& origin,
                           double size, Clipped& clipped, Gatherer& gatherer, bool off_face = false);

}  // namespace crofton::convex
