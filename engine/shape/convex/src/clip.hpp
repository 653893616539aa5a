// SPDX-License-Identifier: MIT
// Patches of two shapes clipped against each other, and the points kept.
#pragma once
#include "features.hpp"

namespace crofton::convex {

// A contact point before its ids are told by shape.
struct ClippedPoint {
    glm::dvec3 on_reference, on_incident;
    Feature reference, incident;
};
inline constexpr int kMaxClipped = 2 * kMaxPatch;
struct Clipped {
    int count = 0;
    ClippedPoint point[kMaxClipped];
};

// The sides of the prism over a polygon along a direction: inside is dot(outward, x) ≤ level. Within `near` of the
// level counts as on the side.
struct Prism {
    int count = 0;
    glm::dvec3 outward[kMaxPatch];
    double level[kMaxPatch], near[kMaxPatch];
};
void find_sides(const Patch& polygon, const glm::dvec3& direction, double size, Prism& sides);

// A polygon while it is clipped: its corners, with the lines that meet in each: edges of the incident patch (numbers
// from 0) or sides of the reference (−1 − number).
struct ClipCorner {
    glm::dvec3 point;
    int before, after;
};
struct ClipPolygon {
    int count = 0;
    ClipCorner corner[kMaxClipped];
};

// The part of the incident patch within the prism over the reference polygon along `direction` (unit, out of the
// reference), and its shadow on the reference's plane. Nothing where that plane is nearly along the direction.
void clip(const Patch& reference, const Prism& sides, const Patch& incident, const glm::dvec3& direction,
          Clipped& clipped);

// The same in two steps, of an incident face of which only what is no higher than `most` along a unit vector matters,
// from where dot(out, x) = level. A contact needs a small part of a steep face, which few sides cut.
void find_low_part(const Patch& incident, const glm::dvec3& out, double level, double most, ClipPolygon& part);
// Whether the shadow of the part is nearer to that of a point than `room`.
[[nodiscard]] bool is_around(const ClipPolygon& part, const glm::dvec3& point, const glm::dvec3& out, double room);
// Leaves out the corners at the height of `most`. Without sides nothing is cut off; of the reference's corners the
// first alone is used then. The part is used up.
void clip(const Patch& reference, const Prism& sides, const Patch& incident, ClipPolygon& part, const glm::dvec3& out,
          Clipped& clipped);

// The same where the reference is the face of a box: in the frame of the box, where the sides are its half extents.
class BoxFace {
  public:
    // `to_local` is the inverse of the pose's rotation; points are around `origin`; `size` is the pair's.
    BoxFace(const ShapeAtPose& box, int face, const glm::dmat3& to_local, const glm::dvec3& origin, double size);
    void clip(const Patch& incident, const glm::dvec3& direction, Clipped& clipped) const;
    // How far a point is within the sides of the prism along the face's own axis: the least distance, negative outside.
    [[nodiscard]] double distance_within(const glm::dvec3& point) const;

  private:
    struct Side {
        int axis;  // of x, y: 0 or 1
        double sign;
    };
    const ShapeAtPose& box_;
    const glm::dmat3& to_local_;
    glm::dvec3 offset_;
    int face_, k_, u_, v_;  // the face's axis and the two along it
    double level_, near_;   // of the face along its axis; as of a prism's sides
    Side sides_[4];         // in the order of the face's edges
};

// Two segments that are nearly parallel: the ends of their common stretch.
void clip_segments(const Patch& reference, const Patch& incident, Clipped& clipped);

// Keeps at most `most` points, in their order: the deepest, the one farthest from it, and those that span most area.
void thin_out(Manifold& manifold, const ContactPoint* points, int count, int most);

}  // namespace crofton::convex
