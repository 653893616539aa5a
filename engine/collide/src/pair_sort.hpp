// Puts a few hundred pairs of triangles in order.
#pragma once
#include <crofton/collide/pair.hpp>
#include <span>

namespace crofton::collide {

// Sorts by first, then second. Allocates nothing.
void sort_pairs(std::span<Pair> pairs);

}  // namespace crofton::collide
