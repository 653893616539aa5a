// SPDX-License-Identifier: MIT
// A tree over boxes that all move: finds those that a ray or a shape may meet.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/shapes.hpp>
#include <cstdint>
#include <span>

namespace crofton::collide {

// A tree whose bounds are made anew for each set of boxes, in an order that is kept while it is good.
class MovingTree {
  public:
    MovingTree();
    ~MovingTree();
    MovingTree(MovingTree&&) noexcept;
    MovingTree& operator=(MovingTree&&) noexcept;

    // Requires valid boxes.
    void update(std::span<const Obb> boxes);

    // Called for a box that may be met: returns how far along the ray, or how far away, others are of interest. A
    // negative number ends the visit.
    using Visitor = FunctionRef<double(std::uint32_t)>;
    // Visit all boxes that may be met, and some others, near ones roughly first: those whose bounds a box meets whose
    // center moves along a ray, or that are within a distance of `bounds`. Rounding errors of 1e-11 of the coordinates
    // are allowed for.
    void visit_along(const Ray& ray, const glm::dvec3& half_size, Visitor visit) const;
    void visit_near(const Aabb& bounds, double distance, Visitor visit) const;

  private:
    struct State;
    Owner<State> state_;
};

}  // namespace crofton::collide
