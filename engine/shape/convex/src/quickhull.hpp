// SPDX-License-Identifier: MIT
// The convex hull of points in space by exact predicates.
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::convex {

struct ExactHull {
    Vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise seen from outside; indices into the points
    glm::dvec3 center{0.0};                          // strictly inside
    // 0: all points are in the hull. Else the hull has max_vertices, and grown by this part about `center` its planes
    // keep all points, up to rounding.
    double missing = 0.0;
};

// Quickhull (Barber, Dobkin, Huhdanpaa 1996) on exact orientations, farthest point first. Only a strictly visible
// triangle is removed, so that no new one is without area and neighbours may be coplanar. Points are finite. Error:
// degenerate.
[[nodiscard]] Result<ExactHull> quickhull(std::span<const glm::dvec3> points, std::size_t max_vertices);

// The vertices of the triangles that are corners, ascending: three planes or more meet there.
[[nodiscard]] Vector<std::uint32_t> corners_of(const ExactHull& hull, std::span<const glm::dvec3> points);

// Whether no point lies outside, exactly.
[[nodiscard]] bool contains_all(const ExactHull& hull, std::span<const glm::dvec3> corners,
                                std::span<const glm::dvec3> points);

}  // namespace crofton::convex
