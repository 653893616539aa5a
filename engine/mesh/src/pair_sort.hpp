// SPDX-License-Identifier: MIT
// Puts a few hundred pairs of triangles in order.
#pragma once
#include <crofton/geometry/shapes.hpp>
#include <span>

namespace crofton::mesh {

// Sorts by first, then second. Allocates nothing.
void sort_pairs(std::span<IdPair> pairs);

}  // namespace crofton::mesh
