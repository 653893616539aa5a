// SPDX-License-Identifier: MIT
// A tree over boxes that all move: finds those that a ray or a shape may meet.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/shapes.hpp>
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

    // Writes the indices of all boxes that may be met, and of some others, in no order, and returns how many: those
    // whose bounds the ray meets, or that are within a distance of `bounds`. More than there is room for: there may be
    // others. Rounding errors of 1e-11 of the coordinates are allowed for.
    [[nodiscard]] std::size_t along(const Ray& ray, std::span<std::uint32_t> indices) const;
    [[nodiscard]] std::size_t near(const Aabb& bounds, double distance, std::span<std::uint32_t> indices) const;

  private:
    struct State;
    Owner<State> state_;
};

}  // namespace crofton::collide
