// SPDX-License-Identifier: MIT
// The bounds of the boxes of a leaf along the world's axes or others, in vectors.
#pragma once
#include <crofton/boxtree/layout.hpp>
#include <span>

namespace crofton::boxtree {

// Where a leaf's compressed boxes begin and end along each axis, in float, relative to the leaf's origin. Each is
// within 2^-24 of itself of the exact number; rounding of the lanes comes on top (see bounds_of).
struct LeafExtent {
    float low[3], high[3];
};

// extents[i] is that of leaves[ids[i]]; low > high for a leaf without items.
void leaf_extents(const Leaf* leaves, std::span<const LeafId> ids, LeafExtent* extents);

// The same along other axes, of a leaf with items: rounded in float (bounds_along).
void turned_leaf_extent(const Leaf& leaf, const Axes& axes, LeafExtent& extent);

}  // namespace crofton::boxtree
