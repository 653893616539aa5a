// SPDX-License-Identifier: MIT
// Branch and bound over rotations, best first. A cell is a cube of Rodrigues vectors (tan(angle / 2) · axis).
#pragma once
#include <algorithm>
#include <array>
#include <crofton/core/memory.hpp>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <utility>

namespace crofton::study {

// Half the side of a cube that holds, up to the 24 rotations of a cube, every rotation: tan(π/8), rounded up.
inline constexpr double kHalfOfAllRotations = 0.41421356237309515;

// The rotation of Rodrigues vector g.
[[nodiscard]] inline glm::dmat3 rotation_of(const glm::dvec3& g) {
    glm::dmat3 result;
    const double scale = 2.0 / (1.0 + glm::dot(g, g));
    for (int k = 0; k < 3; ++k) {
        // Not by e[k] = 1: with -O2 and AVX-512 g++ 12 then makes a matrix of rank 1.
        const glm::dvec3 e(k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0);
        const glm::dvec3 once = glm::cross(g, e);
        result[k] = e + scale * (once + glm::cross(g, once));
    }
    return result;
}

// The Rodrigues vector of rotation_of(g) · rotation_of(from)⁻¹. A projective map of g: cubes become polytopes whose
// corners are the images of theirs, as long as 1 + dot(g, from) > 0.
[[nodiscard]] inline glm::dvec3 turn_between(const glm::dvec3& from, const glm::dvec3& g) {
    return (g - from - glm::cross(g, from)) / (1.0 + glm::dot(g, from));
}

[[nodiscard]] inline glm::dvec3 corner_of(const glm::dvec3& center, double half, unsigned corner) {
    return center + half * glm::dvec3(corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0);
}

// The turns from a cell's middle to its corners, and the length of the longest of them. No rotation of the cell is
// farther from the middle's.
struct CornerTurns {
    std::array<glm::dvec3, 8> turns;
    double longest = 0.0;
};

[[nodiscard]] inline CornerTurns corner_turns(const glm::dvec3& center, double half) {
    CornerTurns result;
    for (unsigned c = 0; c < 8; ++c) {
        result.turns[c] = turn_between(center, corner_of(center, half, c));
        result.longest = std::max(result.longest, glm::length(result.turns[c]));
    }
    return result;
}

// Calls part(center, half) for each of the eight cubes that a cell is divided into.
template <class Part>
void divide(const glm::dvec3& center, double half, Part&& part) {
    for (unsigned c = 0; c < 8; ++c) part(corner_of(center, 0.5 * half, c), 0.5 * half);
}

// Cells that are still to be divided, the least bound first; of equal bounds the oldest cell, so that runs agree.
// A Cell has a member `bound`: no rotation of it has a lower value.
template <class Cell>
class CellQueue {
  public:
    using Bound = decltype(Cell::bound);

    // Counts the cell, and keeps it if it may have less than `known`. Returns whether it is kept.
    bool add(Cell cell, Bound known) {
        ++cells_;
        if (cell.bound >= known) return false;
        heap_.push_back({std::move(cell), cells_});
        std::push_heap(heap_.begin(), heap_.end(), later);
        return true;
    }
    // Removes the cell of the least bound. Not empty.
    [[nodiscard]] Cell take() {
        std::pop_heap(heap_.begin(), heap_.end(), later);
        Cell cell = std::move(heap_.back().cell);
        heap_.pop_back();
        return cell;
    }
    // Whether a cell is left whose bound is below `value`.
    [[nodiscard]] bool has_below(double value) const {
        return !heap_.empty() && static_cast<double>(heap_.front().cell.bound) < value;
    }
    // No rotation of the cells that were added, and not taken, has a lower value. `known` is the least value known, and
    // has not grown since: cells that add() did not keep have no less.
    [[nodiscard]] Bound lower_bound(Bound known) const {
        return heap_.empty() ? known : (std::min)(known, heap_.front().cell.bound);
    }
    [[nodiscard]] std::uint64_t cells() const { return cells_; }

  private:
    struct Entry {
        Cell cell;
        std::uint64_t age;
    };
    static bool later(const Entry& a, const Entry& b) {
        return a.cell.bound != b.cell.bound ? a.cell.bound > b.cell.bound : a.age > b.age;
    }

    Vector<Entry> heap_;
    std::uint64_t cells_ = 0;
};

}  // namespace crofton::study
