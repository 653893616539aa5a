// SPDX-License-Identifier: MIT
// Triangulated polygons as a picture.
#pragma once
#include <crofton/triangulate/triangulate.hpp>
#include <span>
#include <string>

#include "polygon_files.hpp"

namespace crofton::cli {

// Filled polygons with their diagonals thin and their boundary thick; in one frame if they share a plane, else each in
// a cell of a grid. At most `most` polygons are drawn, in the order given. results[i] is for polygons[i]; empty ones
// are left out.
[[nodiscard]] std::string draw_svg(std::span<const NamedPolygon> polygons,
                                   std::span<const triangulate::Triangulation> results, bool one_plane,
                                   std::size_t most = 400);

}  // namespace crofton::cli
