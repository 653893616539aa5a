// SPDX-License-Identifier: MIT
// How far the boxes of leaves reach, in vectors.
#pragma once
#include <crofton/boxtree/layout.hpp>
#include <span>

namespace crofton::boxtree {

// Relative to the leaf's origin, as the stored lanes are in float: the farthest low and high side of the compressed
// boxes. Each is within 2^-24 of itself of the exact number; rounding of the lanes comes on top (see bounds_of).
struct LeafExtent {
    float low[3], high[3];
};

// extents[i] is that of leaves[ids[i]]; low > high for a leaf without items.
void leaf_extents(const Leaf* leaves, std::span<const LeafId> ids, LeafExtent* extents);

// The same along other axes, of a leaf with items: rounded in float (bounds_along).
void turned_leaf_extent(const Leaf& leaf, const Axes& axes, LeafExtent& extent);

}  // namespace crofton::boxtree
