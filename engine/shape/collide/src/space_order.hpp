// SPDX-License-Identifier: MIT
// An order of items in which neighbours in space are neighbours in memory.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <span>

namespace crofton::collide {

// A point amid the boxes, not drawn away by a few far ones: the median of a sample, by component. Non-finite ones are
// left out.
[[nodiscard]] glm::dvec3 middle_of(std::span<const Obb> boxes);

class SpaceOrder {
  public:
    // Boxes by size class, then along a Morton curve, arranged anew within stretches of it. A box at least four times
    // as large as the median comes after those of lesser classes, so that it does not widen the bounds of its small
    // neighbours. Boxes whose numbers are not finite or out of range are left out.
    void sort(std::span<const Obb> boxes);
    [[nodiscard]] std::span<const std::uint32_t> items() const { return items_; }
    // Gives back all memory; items() is empty then.
    void release() { *this = {}; }

  private:
    struct Keyed {
        std::uint32_t key, item;
    };
    static void arrange(std::span<const Keyed> chunk, std::span<const Obb> boxes, const glm::dvec3& origin,
                        std::span<std::uint32_t> items);

    Vector<std::uint32_t> items_;
    Vector<Keyed> keyed_, other_;
};

}  // namespace crofton::collide
