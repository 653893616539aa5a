// From boxes to the topology of a tree: which items share a leaf, which leaves a node.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/geometry/obb.hpp>
#include <crofton/measure/criterion.hpp>
#include <crofton/tree/layout.hpp>
#include <span>

namespace crofton::tree {

// An item as the builder sees it: its axis-aligned box, in float around the scene's middle. It only decides who sits
// beside whom; the bounds themselves are computed from the boxes.
struct BuildItem {
    float low[3];
    float high[3];
    ItemId id;
};

struct Topology {
    struct NodeRecord {
        std::uint32_t child[kWidth];
        std::uint32_t count = 0;
        NodeId parent = kNone;
        std::uint32_t lane_in_parent = 0;
        LeafRange leaves;
    };
    struct LeafRecord {
        std::uint32_t first = 0, count = 0;  // into `order`
        NodeId parent = kNone;
        std::uint32_t lane_in_parent = 0;
    };
    Vector<NodeRecord> nodes;   // parents before children, [0] the root
    Vector<LeafRecord> leaves;  // in the order of a walk from the root
    Vector<ItemId> order;       // the items, leaf by leaf
    unsigned height = 1;
};

[[nodiscard]] Topology build_topology(std::span<const Obb> boxes, std::span<const ItemId> items,
                                      const measure::Criterion& criterion);

}  // namespace crofton::tree
