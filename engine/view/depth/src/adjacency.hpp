// SPDX-License-Identifier: MIT
// Which triangles of a mesh meet along an edge, by position.
#pragma once
#include <crofton/core/memory.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::depth {

struct Adjacency {
    static constexpr std::uint32_t kNone = ~std::uint32_t{0};

    Vector<std::uint32_t> corners;    // three a triangle; equal positions have equal numbers, below position count
    Vector<std::uint32_t> neighbors;  // the triangle across edge (corner k, corner k + 1), or kNone
    Vector<std::uint32_t> fans;       // by corner number: how many triangles with three different corners meet there
    Vector<std::uint8_t> open;        // by corner number: 1 where one of their edges there has no neighbour
};

// Two triangles are neighbours where just these two share the edge, in opposite directions.
[[nodiscard]] Adjacency find_adjacency(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices);

}  // namespace crofton::depth
