// SPDX-License-Identifier: MIT
// Whether a ring touches and crosses itself nowhere, without a triangulation of it.
#pragma once
#include <crofton/core/memory.hpp>
#include <cstddef>
#include <glm/vec2.hpp>
#include <span>

namespace crofton::triangulate {

// Edges are compared through boxes of eight of them. That takes quadratic time, so it is for short rings.
class SimpleRing {
  public:
    static constexpr std::size_t kMostPoints = 1024;

    // 1: simple and counter-clockwise; -1: simple and clockwise, exactly; 0: not known to be simple, as of all rings
    // that have equal neighbours, touch, cross or fold back on themselves. Magnitudes are 0 or within 1e±70. Requires 3
    // to kMostPoints points.
    [[nodiscard]] int turn_of(std::span<const glm::dvec2> points);

  private:
    static constexpr std::size_t kWidth = 8;
    // Boxes of edges, rounded to float. Rounding keeps order, so boxes that meet still do. Unused ones are empty.
    struct Block {
        float low_x[kWidth], high_x[kWidth], low_y[kWidth], high_y[kWidth];
    };
    struct Box {
        float low_x, high_x, low_y, high_y;
    };

    void build(std::span<const glm::dvec2> points);
    [[nodiscard]] bool are_apart(std::span<const glm::dvec2> points, std::size_t a, std::size_t b) const;

    Vector<Block> blocks_;
    Vector<Box> bounds_;  // of the blocks
};

}  // namespace crofton::triangulate
