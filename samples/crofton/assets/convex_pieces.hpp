// SPDX-License-Identifier: MIT
// A triangulated polygon in convex pieces of three or four corners.
#pragma once
#include <array>
#include <crofton/geometry/mesh.hpp>
#include <cstdint>
#include <span>
#include <vector>

namespace crofton::assets {

// Indices of points, counter-clockwise; of a triangle the last is repeated. Two triangles become one piece where they
// are a strictly convex quadrangle together: those with the longest common side first.
[[nodiscard]] std::vector<std::array<std::uint32_t, 4>> convex_pieces(
    const Polygon& polygon, std::span<const std::array<std::uint32_t, 3>> triangles);

}  // namespace crofton::assets
