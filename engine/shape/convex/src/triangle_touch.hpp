// SPDX-License-Identifier: MIT
// The touch of a surface's triangle with a box, a sphere or a capsule, in closed form, with a proof.
#pragma once
#include "touch.hpp"

namespace crofton::convex {

// A surface's triangle in the world: its corners around the surface's origin, its unit normal, zero where it has none.
struct PlacedTriangle {
    glm::dvec3 corner[3], normal;
};
// Without the normal.
[[nodiscard]] PlacedTriangle placed_corners(const Triangle& corners, const RigidTransform& pose,
                                            const glm::dvec3& origin);
[[nodiscard]] PlacedTriangle placed_triangle(const Triangle& corners, const RigidTransform& pose,
                                             const glm::dvec3& origin);

// A box, rounded or not. The least extent of the difference body of two convex polytopes is across one of their faces,
// or across an edge of each: 13 axes, both ways. A box is a parallelepiped, since its pose is rigid to 1e-6 alone. So
// axes are covectors of its own frame, m, of length √(mᵀ G m) in the world, where G is I but for that. An axis across
// two edges is off by 8u size / |m| in direction. That moves its extent by no more than 1e-10 of the size, unless |m|
// is below 1e-5 of the difference body's reach. Then the answer is `unknown`. Edges that are parallel to 1e-10 of the
// size lose no more than that. The same holds for the normals of slivers. So the answer is `unknown`, too, where the
// least extent is nearer to 0 than these together.
class BoxTouch {
  public:
    // `reach` is the surface's; the box stands in the world, the triangles around the surface's origin.
    BoxTouch(const ShapeAtPose& box, const glm::dvec3& origin, double reach, double margin);
    // touching: sets normal, depth, deepest points and features. apart: surely farther than the margin. The triangle's
    // normal is not used.
    [[nodiscard]] Warm ask(const PlacedTriangle& triangle, Touch& touch) const;

    // The box's inverse rotation.
    [[nodiscard]] const glm::dmat3& to_local() const { return to_local_; }

  private:
    struct Axis;
    struct Local;
    void try_faces(const Local& t, Axis& least) const;
    [[nodiscard]] bool try_edges(const Local& t, Axis& least) const;
    [[nodiscard]] bool set_points(const Local& t, const Axis& axis, const PlacedTriangle& triangle, Touch& touch) const;
    [[nodiscard]] int lowest_corner(const glm::dvec3& m) const;

    const ShapeAtPose& box_;
    glm::dvec3 offset_, half_;  // of the box from the surface's origin
    glm::dvec3 unit_;           // lengths of the frame's covectors in the world
    glm::dmat3 to_local_, metric_;
    double size_, error_, margin_;
};

// A sphere or a capsule: a segment or point with a rounding. The nearest points are found case by case (Ericson 2005,
// ch. 5), then proven by the extent along the direction between them, so that the cases need no proof.
class SegmentTouch {
  public:
    SegmentTouch(const ShapeAtPose& shape, const glm::dvec3& origin, double reach, double margin);
    // `gap` is set where the shapes are too near to a touch to tell whether they meet: no more than that is between
    // them.
    [[nodiscard]] Warm ask(const PlacedTriangle& triangle, Touch& touch, double* gap = nullptr) const;

  private:
    glm::dvec3 end_[2];
    int count_;
    double radius_, error_, doubt_, limit_;
};

}  // namespace crofton::convex
