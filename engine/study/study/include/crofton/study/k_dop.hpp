// SPDX-License-Identifier: MIT
// k-DOPs, convex polytopes with faces perpendicular to k/2 fixed directions, as an alternative to boxes and spheres.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::study {

// Returns half of a k-DOP's directions as unit vectors: the coordinate axes, and the cube's diagonals (14), its faces'
// diagonals (18), or both (26). Errors: k is none of 6, 14, 18, 26.
[[nodiscard]] Result<Vector<glm::dvec3>> k_dop_directions(std::uint32_t k);

// { x : low[i] ≤ dot(directions[i], x) ≤ high[i] }, and its corners.
struct KDop {
    Vector<glm::dvec3> directions;
    Vector<double> low, high;
    Vector<glm::dvec3> corners;
};

// Returns the smallest k-DOP with these directions around the points: every slab touches two of them. Directions may
// have any length whose square is neither 0 nor infinite.
//
// Errors: no points, NaN or infinite ones (by index); more than 64 directions; a direction that is 0 or not finite (by
// index); directions that all lie in a plane.
[[nodiscard]] Result<KDop> k_dop_around(std::span<const glm::dvec3> points, std::span<const glm::dvec3> directions);

}  // namespace crofton::study
