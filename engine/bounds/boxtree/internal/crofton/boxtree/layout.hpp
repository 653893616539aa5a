// SPDX-License-Identifier: MIT
// How nodes and leaves of a BoxTree lie in memory: plain arrays that vector kernels read as they are. There is no GLM
// here, so that kernels compile for any target.
#pragma once
#include <crofton/core/version.hpp>
#include <cstdint>

namespace crofton::boxtree {

using ItemId = std::uint32_t;
using NodeId = std::uint32_t;
using LeafId = std::uint32_t;
inline constexpr std::uint32_t kNone = ~std::uint32_t{0};
inline constexpr unsigned kWidth = 16;  // children of a node, items of a leaf: one AVX-512 register of floats
// Two 16-bit integers in two's complement side by side, as instructions that sum products of pairs take them.
using Int16x2 = std::uint32_t;
[[nodiscard]] constexpr Int16x2 pair_of(int lower, int upper) {
    return (static_cast<std::uint32_t>(lower) & 0xffffu) | static_cast<std::uint32_t>(upper) << 16;
}
[[nodiscard]] constexpr int lower_of(Int16x2 pair) {
    return static_cast<std::int16_t>(pair & 0xffffu);
}
[[nodiscard]] constexpr int upper_of(Int16x2 pair) {
    return static_cast<std::int16_t>(pair >> 16);
}

inline constexpr std::uint32_t kLeafBit = 0x80000000u;  // in Node::child: the rest is a LeafId, otherwise a NodeId

// Axes that bounds are taken along: rows[k] are the world's coordinates of axis k. The world's own are the first of
// every tree. Others are orthonormal to 2^-48; coordinates along them are known to `rounding` times the sizes of those
// that they are made of (src/turned_bounds.hpp).
struct Axes {
    double rows[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    double rounding = 0.0;
};

// A vector's coordinate along axis k.
[[nodiscard]] inline double along(const Axes& axes, unsigned k, const double* vector) {
    const double* row = axes.rows[k];
    return row[0] * vector[0] + row[1] * vector[1] + row[2] * vector[2];
}

// Boxes of up to 16 children: origin + Σ axis k · unit · [middle − half, middle + half] of k, rounded outward; both
// ends fit 16 bits. The axes are the tree's with the index `axes`; the origin is in the world's coordinates. `unit` is
// a power of two, so that products with it are exact. An empty child has half = −32767. Layers are read only where the
// view does not share one with everything below.
// `rounding` is what a plane's value on a child's box may be off by, where the plane's normal is in units of 2^-14 (see
// rounding_of). `per_quantum` units of 2^-14 of a unit are 1.
struct alignas(64) Node {
    double origin[3];
    float unit;
    float l1_radius;  // ≥ the farthest |x| + |y| + |z|, relative to the origin and along the axes, of every child
    std::uint32_t count;
    NodeId parent;  // kNone for the root
    std::uint32_t lane_in_parent;
    std::uint32_t only_leaves;   // 1 if all children are leaves
    std::uint32_t layers_every;  // the AND of layers_all
    float per_quantum;
    float rounding;
    std::uint32_t axes;
    alignas(64) Int16x2 middle_xy[kWidth];
    Int16x2 middle_half_z[kWidth];  // middle's z, half's z
    Int16x2 half_xy[kWidth];
    std::uint32_t child[kWidth];
    std::uint32_t layers_any[kWidth];  // OR and AND of the layer masks below
    std::uint32_t layers_all[kWidth];
};

// Where a child's box begins and ends along an axis, in the node's units.
[[nodiscard]] constexpr int middle_of(const Node& node, unsigned lane, unsigned axis) {
    return axis == 0   ? lower_of(node.middle_xy[lane])
           : axis == 1 ? upper_of(node.middle_xy[lane])
                       : lower_of(node.middle_half_z[lane]);
}
[[nodiscard]] constexpr int half_of(const Node& node, unsigned lane, unsigned axis) {
    return axis == 0   ? lower_of(node.half_xy[lane])
           : axis == 1 ? upper_of(node.half_xy[lane])
                       : upper_of(node.middle_half_z[lane]);
}
[[nodiscard]] constexpr int low_of(const Node& node, unsigned lane, unsigned axis) {
    return middle_of(node, lane, axis) - half_of(node, lane, axis);
}
[[nodiscard]] constexpr int high_of(const Node& node, unsigned lane, unsigned axis) {
    return middle_of(node, lane, axis) + half_of(node, lane, axis);
}

// Up to 16 oriented boxes, compressed for filtering. Lane i < count holds an item. Its centre is within half a
// position_unit, along each axis, of origin + position_unit · (x, y, z). Each component of its half edges is within
// half an edge_unit of edge_unit times the integer that stands for it. Units are powers of two, edge_unit ≤
// position_unit; `per_quantum` units of 2^-14 of a position_unit are 1; `rounding` as a node's.
struct alignas(64) Leaf {
    double origin[3];
    float position_unit, edge_unit;
    float l1_radius;  // ≥ |x| + |y| + |z| of every lane's position, relative to the origin
    float rounding;
    float per_quantum;
    std::int32_t edge_shift;  // a position_unit is 2^edge_shift edge_units, or more if this is 31
    std::uint32_t count;
    NodeId parent;
    std::uint32_t lane_in_parent;
    std::uint32_t layers_every;  // bits that all lanes' layers have
    alignas(64) Int16x2 xy[kWidth];
    Int16x2 z_edge2_z[kWidth];  // z, edge 2's z
    Int16x2 edge_xy[3][kWidth];
    Int16x2 edge01_z[kWidth];  // edge 0's z, edge 1's z
    std::uint32_t layers[kWidth];
};
static_assert(sizeof(Node) == 448 && sizeof(Leaf) == 512);

// A normal's component that is rounded to 2^-14 is off by half of that, so a value by 2^-15 · (|x| + |y| + |z|): the
// L1 radius's share; the last factor covers the sums' own rounding, and 3 units of 2^-14 of a unit that a kernel loses
// by cutting off the fractions of an offset, an error bound and a shifted sum.
[[nodiscard]] inline float rounding_of(const Node& node) {
    return (0x1.01p-15f * node.l1_radius + 0x1p-12f * node.unit) * (1.0f + 0x1p-20f);
}
// Besides, the rounding of the lanes. Of the position: half a unit along each axis, 2^13 · Σ|normal| ≤ 2^13 · √3 ·
// 1.0005 < 0.87 · 2^14. Of three edges, no component of which is beyond 2^15: 0.502 of a unit, as the position's, and
// the normal's, half of the nine components' sum; in all less than 12 edge_units.
[[nodiscard]] inline float rounding_of(const Leaf& leaf) {
    return (0x1.01p-15f * leaf.l1_radius + (1.0f + 0x1p-12f) * leaf.position_unit + 12.0f * leaf.edge_unit) *
           (1.0f + 0x1p-20f);
}

// A range of radii of items (radius_range.hpp).
using RadiusRange = std::uint32_t;

// The radii of the items below each child of a node, in an array parallel to the nodes.
struct alignas(64) NodeRadii {
    RadiusRange below[kWidth];
};

// Versions the assignment of items to slots and nodes: equal versions, equal places. No two structures share one.
struct SlotsVersion {
    std::uint64_t structure = 0, changes = 0;
    [[nodiscard]] constexpr bool operator==(const SlotsVersion&) const = default;
};

// The leaves below a node, where they are consecutive (they are after a build): count 0 says they are not.
struct LeafRange {
    LeafId first = 0;
    std::uint32_t count = 0;
    std::uint32_t items = 0;  // how many, where they fill the leaves' slots without gaps; 0 says they may not
};

}  // namespace crofton::boxtree
