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

// Axis-aligned boxes of up to 16 children, relative to `origin`, rounded outward. Lanes from `count` on are empty:
// half = −infinity, so that no test passes.
struct alignas(64) Node {
    float center[3][kWidth];
    float half[3][kWidth];
    std::uint32_t child[kWidth];
    std::uint32_t layers_any[kWidth];  // OR and AND of the layer masks below
    std::uint32_t layers_all[kWidth];
    double origin[3];
    float reach;  // ≥ |center| + half, summed over the axes, for every child
    std::uint32_t count;
    NodeId parent;  // kNone for the root
    std::uint32_t lane_in_parent;
    std::uint32_t only_leaves;  // 1 if all children are leaves
};

// Up to 16 oriented boxes, compressed for filtering. Lane i < count holds an item:
// its centre within the ball of (x, y, z) + origin that `radius` accounts for, its whole box within `radius` of there,
// and its half edges as edge[3 k + j] · radius · 2^-15, component j of edge k, each within one such unit.
struct alignas(64) Leaf {
    float x[kWidth], y[kWidth], z[kWidth];
    float radius[kWidth];  // −infinity in empty lanes
    std::int16_t edge[9][kWidth];
    std::uint32_t layers[kWidth];
    double origin[3];
    float reach;  // ≥ |x| + |y| + |z| of every lane
    std::uint32_t count;
    NodeId parent;
    std::uint32_t lane_in_parent;
};
inline constexpr float kEdgeUnit = 0x1p-15f;  // of the radius
inline constexpr float kMinRadius = 1e-30f;   // keeps units normal numbers

// The leaves below a node, where they are consecutive (they are after a build): count 0 says they are not.
struct LeafRange {
    LeafId first = 0;
    std::uint32_t count = 0;
};

}  // namespace crofton::tree
