// SPDX-License-Identifier: MIT
// Bounds how far two moving shapes approach a plane between them.
#pragma once
#include "core_query.hpp"

namespace crofton::convex {

// How far one shape comes towards a plane within time s: along d (unit, in the world), from where it stands now.
//
// A point at r from the pivot has dot(d, position)' = dot(d, velocity + spin × r) now, and later
// dot(d, position)'' = dot(d, spin × (spin × r)) ≤ |d × spin| |spin| |r|, since |spin × r| never changes. So within s
// it grows by at most s · dot(d, velocity + spin × r) + s²/2 · |d × spin| |spin| |r|. The greatest sum of that and of
// dot(d, r) over the core is a support of the core along d + s · (d × spin).
//
// A spin around its own axis does not move a solid of revolution. Of the axis u the bound uses the angular velocity
// u × u', whose length is w = |spin × u|, and whose derivative is at most |spin| w.
class Advance {
  public:
    Advance(const ShapeAtPose& now, const Motion& motion, const glm::dvec3& d);
    [[nodiscard]] double operator()(double s) const {
        return turns_ ? core_support(shape_, local_ + s * turned_).along - now_ + s * drift_ + s * s * bend_
                      : s * drift_;
    }
    [[nodiscard]] bool turns() const { return turns_; }
    // It is not less than rate · s + bend · s².
    [[nodiscard]] double rate() const { return rate_; }
    [[nodiscard]] double bend() const { return bend_; }

  private:
    void set_support(const glm::dvec3& local);
    bool turn_as_solid_of_revolution(const ShapeAtPose& now, const Motion& motion, const glm::dvec3& d, double arm);

    const Shape& shape_;
    glm::dvec3 local_{0.0}, turned_{0.0};
    double now_ = 0.0, drift_ = 0.0, rate_ = 0.0, bend_ = 0.0;
    bool turns_ = false;
};

// How far two shapes come together across a plane.
class Closing {
  public:
    // At most, within time s.
    [[nodiscard]] double operator()(double s) const { return (a_(s) + b_(s)) + s * growth_; }
    // The greatest step up to `limit` in which they come together by less than `gap` > 0: exact where neither turns,
    // else within 1 % below.
    [[nodiscard]] double safe_step(double gap, double limit) const;

  private:
    friend class Flight;
    Closing(const Advance& a, const Advance& b, double growth) : a_(a), b_(b), growth_(growth) {}
    const Advance a_, b_;
    const double growth_;  // of the error of both paths, as time goes on
};

// Two shapes that move, seen from a's origin: what `advance` asks of them. Far from the world's origin, or where both
// fly fast, places in the world lack the digits that decide.
class Flight {
  public:
    Flight(const ShapeAtPose& a, const Motion& motion_a, const ShapeAtPose& b, const Motion& motion_b);

    void move_to(double time);
    [[nodiscard]] double time() const { return time_; }
    [[nodiscard]] ShapeAtPose a() const { return {shape_a_, pose_a_}; }
    [[nodiscard]] ShapeAtPose b() const { return {shape_b_, pose_b_}; }
    // How far the shapes may be from where the real paths have them: by rounding of rotations and ways.
    [[nodiscard]] double path_error() const { return error_at_start_ + growth_ * time_; }
    [[nodiscard]] bool rests() const;
    [[nodiscard]] bool turns() const;
    [[nodiscard]] double size() const { return size_; }  // of the pair at the start
    // How far they go within a time, seen from a.
    [[nodiscard]] double way(double within) const;
    [[nodiscard]] glm::dvec3 in_world(const glm::dvec3& point) const;

    // Across a plane between the shapes where they stand now; `normal` is its unit normal, from a to b.
    [[nodiscard]] Closing closing(const glm::dvec3& normal) const;

  private:
    const Shape &shape_a_, &shape_b_;
    const RigidTransform start_a_, start_b_;
    const Motion turn_a_, way_b_;
    const glm::dvec3 origin_, velocity_;
    double error_at_start_ = 0.0, growth_ = 0.0, size_ = 0.0, time_ = 0.0;
    RigidTransform pose_a_, pose_b_;
};

}  // namespace crofton::convex
