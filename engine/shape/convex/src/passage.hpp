// SPDX-License-Identifier: MIT
// Lower bounds for the time at which a convex shape that moves along a line reaches what is near its path.
#pragma once
#include "parts.hpp"

namespace crofton::convex {

// The shape and its way as a surface sees them that stands still. The shape stands for its bounds: a box, of spheres,
// capsules and rounded shapes with rounded edges. "Near" is within half the tolerance, as hits are told.
class Passage {
  public:
    // `velocity` is the shape's, seen from the surface, in the world; not 0. `bounds` are the surface's. The shape
    // stands as at time 0.
    Passage(const ShapeAtPose& shape, const RigidTransform& surface, const Aabb& bounds, const glm::dvec3& velocity,
            double from, double to, double tolerance);

    // Times in which the shape may be near anything of the surface; none if `from() > to()`.
    [[nodiscard]] double from() const { return from_; }
    [[nodiscard]] double to() const { return to_; }

    struct Entry {
        double time;    // not after the first one, up to `until`, at which the shape is near; infinite if it never is
        bool is_apart;  // at the start: farther than the tolerance
    };
    // Of a triangle of the surface, by separating axes of moving shapes (Eberly 2001).
    [[nodiscard]] Entry entry(const Triangle& corners, double until) const;
    // The time of a box in the surface's frame.
    [[nodiscard]] double entry(const Aabb& box, double until) const;

    // Call `visit` for triangles of the surface that the shape may be near up to `until`, which the visitor may lessen;
    // about the first first, in an order that depends on the machine.
    using TriangleInPath = FunctionRef<void(const Triangle& corners, std::uint32_t triangle)>;
    void visit_mesh(const Shape& shape, const double& until, TriangleInPath visit) const;
    void visit_field(const HeightField& field, const double& until, TriangleInPath visit) const;

  private:
    struct Stretch;
    void cut(const glm::dvec3 (&p)[3], const glm::dvec3& axis, Stretch& met) const;

    QueryBox box_;                      // the core, at the time `middle_`
    Aabb bounds_;                       // around it, with its rounding and `left`
    glm::dvec3 velocity_, along_{0.0};  // of the box in the surface's frame, and in its own
    glm::dmat3 to_box_;
    double middle_ = 0.0, from_, to_, speed_ = 0.0;
    double radius_ = 0.0, left_ = 0.0, more_ = 0.0;  // with all roundings; up to the tolerance
    bool is_late_ = false;                           // at the start it is far from all of the surface
};

}  // namespace crofton::convex
