// SPDX-License-Identifier: MIT
// The inside of a piece as cells of a grid, and the box of cells that hides most.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/occlude/occluder.hpp>
#include <cstdint>

#include "finding/inscribed_box.hpp"

namespace crofton::occlude {

// Cells that lie inside and that no triangle meets; rounded, so what is found here is a proposal. Bit x of a row stands
// for a cell.
class SolidGrid {
  public:
    static constexpr std::uint32_t kMaxCells = 32;

    SolidGrid(const FramedPiece& piece, Sides sides, std::uint32_t cells);

    // The box of free cells of the largest mean shadow, weighted by the share of its cells that are not covered yet.
    // Grown no further than the cells; empty (low = high) where none comes to more than `least`.
    [[nodiscard]] FrameBox best_box(double least) const;
    // Cells whose centres lie in the box count as covered from now on.
    void cover(const FrameBox& box);

  private:
    void mark_surface(const FramedPiece& piece);
    void fill_inside(const FramedPiece& piece, Sides sides);
    void count_uncovered();
    [[nodiscard]] std::uint32_t cell_at(int axis, double coordinate) const;
    [[nodiscard]] std::uint32_t& row(std::uint32_t y, std::uint32_t z) { return free_[z * n_ + y]; }
    [[nodiscard]] std::uint32_t uncovered(const std::uint32_t (&low)[3], const std::uint32_t (&high)[3]) const;
    [[nodiscard]] std::size_t sum_at(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
        return (std::size_t{z} * (n_ + 1) + y) * (n_ + 1) + x;
    }

    std::uint32_t n_;
    glm::dvec3 low_, cell_;
    Vector<std::uint32_t> free_;     // rows along x
    Vector<std::uint32_t> covered_;  // as free_
    Vector<std::uint32_t> sums_;     // of free cells that are not covered, below a corner
};

}  // namespace crofton::occlude
