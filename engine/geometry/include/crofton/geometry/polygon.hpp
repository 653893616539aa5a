// SPDX-License-Identifier: MIT
// A planar polygon with holes.
#pragma once
#include <crofton/core/memory.hpp>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>

namespace crofton {

// Rings one after another in `points`; ring r is [ring_ends[r−1], ring_ends[r]), the first is the outer one, the others
// holes. Rings are closed implicitly and may have either orientation; triangle indices refer to `points`.
struct Polygon {
    Vector<glm::dvec2> points;
    Vector<std::uint32_t> ring_ends;

    [[nodiscard]] std::size_t ring_count() const { return ring_ends.size(); }
    [[nodiscard]] std::span<const glm::dvec2> ring(std::size_t r) const {
        const std::size_t begin = r == 0 ? 0 : ring_ends[r - 1];
        return std::span<const glm::dvec2>(points).subspan(begin, ring_ends[r] - begin);
    }
};

}  // namespace crofton
