// Writing boxes into leaves and bounds into nodes, rounded outward.
#pragma once
#include <crofton/geometry/obb.hpp>
#include <crofton/tree/layout.hpp>

namespace crofton::tree {

void clear(Node& node);
void clear(Leaf& leaf);

// Puts a box into a lane; the leaf's origin stays, its reach grows where needed.
void write_lane(Leaf& leaf, unsigned lane, const Obb& box, std::uint32_t layers);
void clear_lane(Leaf& leaf, unsigned lane);

// Puts a child's bound into a lane; the node's origin stays, its reach grows where needed.
void write_lane(Node& node, unsigned lane, const Aabb& bounds);
void clear_lane(Node& node, unsigned lane);

// OR and AND of `count` masks each.
void write_layers(Node& node, unsigned lane, const std::uint32_t* any, const std::uint32_t* all, std::uint32_t count);

[[nodiscard]] Aabb bounds_of(const Leaf& leaf);
[[nodiscard]] Aabb bounds_of(const Node& node);
[[nodiscard]] Aabb bounds_of_lane(const Node& node, unsigned lane);

}  // namespace crofton::tree
