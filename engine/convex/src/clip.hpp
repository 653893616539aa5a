// SPDX-License-Identifier: MIT
// Patches of two bodies clipped against each other, and the points kept.
#pragma once
#include "features.hpp"

namespace crofton::convex {

// A contact point before its ids are told by body.
struct ClippedPoint {
    glm::dvec3 on_reference, on_incident;
    Feature reference, incident;
};
// A contact point, without the defaults that would be written over all of a long array.
struct RawPoint {
    glm::dvec3 position;
    double depth;
    Feature on_a, on_b;
    PartId part_a, part_b;
};
inline constexpr int kMaxClipped = 2 * kMaxPatch;
struct Clipped {
    int count = 0;
    ClippedPoint point[kMaxClipped];
};

// The sides of the prism over a polygon along a direction: inside is dot(outward, x) ≤ level.
struct Prism {
    int count = 0;
    glm::dvec3 outward[kMaxPatch];
    double level[kMaxPatch];
};
void find_sides(const Patch& polygon, const glm::dvec3& direction, Prism& sides);

// The part of the incident patch within the prism over the reference polygon along `direction` (unit, out of the
// reference), and its shadow on the reference's plane. Nothing where that plane is nearly along the direction.
void clip(const Patch& reference, const Prism& sides, const Patch& incident, const glm::dvec3& direction,
          Clipped& clipped);

// Two segments that are nearly parallel: the ends of their common stretch.
void clip_segments(const Patch& reference, const Patch& incident, Clipped& clipped);

// Keeps at most `most` points, in their order: the deepest, the one farthest from it, and those that span most area.
void thin_out(Manifold& manifold, const RawPoint* points, int count, int most);

}  // namespace crofton::convex
