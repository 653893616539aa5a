// SPDX-License-Identifier: MIT
// An order in which points that are near each other are near in memory, and that cuts into halves by straight lines.
#pragma once
#include <crofton/core/memory.hpp>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>

namespace crofton::triangulate {

// Sorts points along the Z-order curve of a grid of some 16 cells a point, those of one cell lexicographically, then by
// index. Codes have the cell's bits interleaved, those of y in even places. Where codes first differ in bit b, a
// vertical (odd b) or horizontal line separates the points strictly; within a cell, a slightly tilted vertical one.
class SpatialOrder {
  public:
    struct Entry {
        std::uint32_t code, index;
    };
    // Valid until the next call. Positions must be finite.
    [[nodiscard]] std::span<const Entry> sort(std::span<const glm::dvec2> points);

  private:
    void encode(std::span<const glm::dvec2> points);
    void sort_by_code();

    Vector<Entry> entries_, buffer_;
};

}  // namespace crofton::triangulate
