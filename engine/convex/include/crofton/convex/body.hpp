// SPDX-License-Identifier: MIT
// A convex body, whichever kind: what every query of this module takes.
#pragma once
#include <crofton/convex/hull.hpp>
#include <crofton/geometry/shapes.hpp>
#include <glm/vec3.hpp>

namespace crofton::convex {

enum class Kind : std::uint8_t { ball, capsule, cylinder, cone, box, triangle, hull, half_space };

// A small value; of a hull it is a view, which the caller keeps alive. Solids of revolution stand along the frame's y
// axis, with the origin half way up. Made by the functions below, which refuse NaN, infinite and negative lengths, and
// lengths beyond kMaxExtent; zero lengths are allowed, and give a segment, a disc, a point.
class Body {
  public:
    [[nodiscard]] static Result<Body> ball(float radius);
    // All points within `radius` of the segment from −half_height to half_height.
    [[nodiscard]] static Result<Body> capsule(float half_height, float radius);
    [[nodiscard]] static Result<Body> cylinder(float half_height, float radius);
    // The apex is at half_height, the disc of `radius` at −half_height.
    [[nodiscard]] static Result<Body> cone(float half_height, float radius);
    // A negative half extent would turn the box inside out: refused with the axis as the item.
    [[nodiscard]] static Result<Body> box(const glm::vec3& half_extents);
    // Counter-clockwise seen from its front; may be a segment or a point. The item of an error is the corner.
    [[nodiscard]] static Result<Body> triangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);
    [[nodiscard]] static Body hull(const Hull& hull);
    // { x : dot(normal, x) + offset ≥ 0 }: `normal`, of any length but 0, points into the solid, as everywhere.
    [[nodiscard]] static Result<Body> half_space(const Plane& plane);
    // All points within `radius` of `core`: of any kind but a half-space.
    [[nodiscard]] static Result<Body> rounded(const Body& core, float radius);

    [[nodiscard]] Kind kind() const { return kind_; }
    [[nodiscard]] double radius() const { return radius_; }  // of the rounding; of balls and capsules
    [[nodiscard]] const Hull* hull() const { return hull_; }
    [[nodiscard]] const Plane& plane() const { return plane_; }
    // Boxes. Of cylinders and cones: radius, half height, radius.
    [[nodiscard]] const glm::dvec3& half_extents() const { return half_; }
    // Whether the core, that is the body without its rounding, is the hull of finitely many points.
    [[nodiscard]] bool has_polytope_core() const { return vertex_count_ > 0; }
    [[nodiscard]] bool is_polytope() const { return vertex_count_ > 0 && radius_ == 0.0; }
    [[nodiscard]] int vertex_count() const { return vertex_count_; }  // of the core: ball 1, capsule 2, box 8
    [[nodiscard]] glm::dvec3 vertex(int i) const {
        const std::size_t at = static_cast<std::size_t>(i);
        return {column(0)[at], column(1)[at], column(2)[at]};
    }
    // Corner i of a box is on the + side of axis k where bit k of i is set.
    [[nodiscard]] const double* column(int k) const { return hull_ != nullptr ? hull_->column(k) : corners_[k]; }
    [[nodiscard]] int padded_count() const { return hull_ != nullptr ? hull_->padded_count() : padded_; }
    // Of the ball around the frame's origin that contains the core, rounded up; infinite for half-spaces.
    [[nodiscard]] double reach() const { return reach_; }

  private:
    Body() = default;
    void set_corners(std::span<const glm::dvec3> corners);

    Kind kind_ = Kind::ball;
    int vertex_count_ = 0, padded_ = 0;
    double radius_ = 0.0, reach_ = 0.0;
    glm::dvec3 half_{0.0};
    Plane plane_;
    const Hull* hull_ = nullptr;
    double corners_[3][8] = {};
};

// Exact formulas, rounded, for every kind but half-spaces and roundings of boxes, triangles, hulls, cylinders, cones:
// there `unsupported`. A triangle has volume 0.
[[nodiscard]] Result<MassProperties> mass_properties(const Body& body);

// The farthest point of the body along `direction` (finite; any length but 0), in its frame. Not for half-spaces.
[[nodiscard]] glm::dvec3 support_point(const Body& body, const glm::dvec3& direction);

}  // namespace crofton::convex
