// How a BoxTree lies in memory: plain arrays that vector kernels read as they are (no GLM here, see DESIGN section 3).
#pragma once
#include <cstdint>

namespace crofton::tree {

using ItemId = std::uint32_t;
using NodeId = std::uint32_t;
using LeafId = std::uint32_t;
inline constexpr std::uint32_t kNone = ~std::uint32_t{0};
inline constexpr unsigned kWidth = 16;  // children of a node, items of a leaf: one AVX-512 register of floats
inline constexpr std::uint32_t kLeafBit = 0x80000000u;  // in Node::child: the rest is a LeafId, otherwise a NodeId

// Axis-aligned boxes of up to 16 children: origin + unit · [low, high], rounded outward. `unit` is a power of two, so that
// products with it are exact. An empty child has low > high. Layers are read only where the view does not share one with
// everything below.
struct alignas(64) Node {
    double origin[3];
    float unit;
    float reach;  // ≥ the farthest |x| + |y| + |z|, relative to the origin, of every child
    std::uint32_t count;
    NodeId parent;  // kNone for the root
    std::uint32_t lane_in_parent;
    std::uint32_t only_leaves;   // 1 if all children are leaves
    std::uint32_t layers_every;  // the AND of layers_all
    alignas(64) std::int16_t low[3][kWidth];
    std::int16_t high[3][kWidth];
    std::uint32_t child[kWidth];
    std::uint32_t layers_any[kWidth];  // OR and AND of the layer masks below
    std::uint32_t layers_all[kWidth];
};

// Up to 16 oriented boxes, compressed for filtering. Lane i < count holds an item: its centre within half a
// position_unit, along each axis, of origin + position_unit · position, and component j of its half edge k within half an
// edge_unit of edge_unit · edge[3 k + j]. Units are powers of two.
struct alignas(64) Leaf {
    double origin[3];
    float position_unit, edge_unit;
    float slack;  // what both roundings together can change in the distance of a box's farthest point from a plane
    float reach;  // ≥ |x| + |y| + |z| of every lane's position, relative to the origin
    std::uint32_t count;
    NodeId parent;
    std::uint32_t lane_in_parent;
    std::uint32_t layers_every;  // bits that all lanes' layers have
    alignas(64) std::int16_t position[3][kWidth];
    std::int16_t edge[9][kWidth];
    std::uint32_t layers[kWidth];
};
static_assert(sizeof(Node) == 448 && sizeof(Leaf) == 512);

// The leaves below a node, where they are consecutive (they are after a build): count 0 says they are not.
struct LeafRange {
    LeafId first = 0;
    std::uint32_t count = 0;
    std::uint32_t items = 0;  // how many, where they fill the leaves' slots without gaps; 0 says they may not
};

}  // namespace crofton::tree
