// SPDX-License-Identifier: MIT
// Writing boxes into leaves and bounds into nodes, rounded outward.
#pragma once
#include <crofton/boxtree/layout.hpp>
#include <crofton/geometry/box.hpp>

#include "leaf_extents.hpp"

namespace crofton::boxtree {

void clear(Node& node);
void clear(Leaf& leaf);

// A leaf's origin and units for boxes whose centres lie in `centers` and whose half edges are no longer than
// `longest_edge`, with room to move. All lanes must be rewritten.
void fit_frame(Leaf& leaf, const Aabb& centers, double longest_edge);
[[nodiscard]] double longest_edge(const Obb& box);
// Does the frame keep the promises that Leaf states?
[[nodiscard]] bool is_frame(const Leaf& leaf);

// Puts a box into a lane; the leaf's frame stays, its L1 radius grows where needed. False, and nothing is written, if
// the box does not fit into the frame.
[[nodiscard]] bool write_lane(Leaf& leaf, unsigned lane, const Obb& box);
void write_layers(Leaf& leaf, unsigned lane, std::uint32_t layers);
void clear_lane(Leaf& leaf, unsigned lane);

// Bounds of nodes and children are in coordinates along the node's axes, which count from the world's origin.

// A node's origin and unit for children that lie in `whole`, with room to move; all lanes must be rewritten.
void fit_frame(Node& node, const Aabb& whole, const Axes& axes);
[[nodiscard]] bool is_frame(const Node& node);

// Puts a child's bound into a lane; the node's frame stays, its L1 radius grows where needed. False, and nothing is
// written, if it does not fit.
[[nodiscard]] bool write_lane(Node& node, unsigned lane, const Aabb& bounds, const Axes& axes);
void clear_lane(Node& node, unsigned lane);

// OR and AND of `count` masks each.
void write_layers(Node& node, unsigned lane, const std::uint32_t* any, const std::uint32_t* all, std::uint32_t count);

// Along the world's axes.
[[nodiscard]] Aabb bounds_of(const Leaf& leaf);
[[nodiscard]] Aabb bounds_of(const Leaf& leaf, const LeafExtent& extent);

// Where the children's boxes begin and end along each axis, in the node's units. Those of empty lanes are the largest
// low and the least high.
struct ChildEnds {
    float low[3][kWidth], high[3][kWidth];
};
[[nodiscard]] ChildEnds ends_of(const Node& node);

[[nodiscard]] Aabb bounds_of(const Node& node, const Axes& axes);
[[nodiscard]] Aabb bounds_of_lane(const Node& node, unsigned lane, const Axes& axes);

// A box around a point of the world, from ends relative to it; moved outward by `rounding` times the sizes.
[[nodiscard]] Aabb around(const Axes& axes, const double* origin, const double (&low)[3], const double (&high)[3],
                          double rounding);

}  // namespace crofton::boxtree
