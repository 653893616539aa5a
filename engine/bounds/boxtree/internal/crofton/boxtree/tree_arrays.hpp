// SPDX-License-Identifier: MIT
// The arrays that queries of an unchanging tree read.
#pragma once
#include <crofton/boxtree/structure.hpp>

namespace crofton::boxtree {

// In one place, so that no pointer need be followed before the tree's nodes can be prefetched.
struct TreeArrays {
    const Node* nodes = nullptr;
    const Leaf* leaves = nullptr;
    const LeafRange* ranges = nullptr;
    const std::uint8_t* leaf_counts = nullptr;
    const ItemId* slot_items = nullptr;
    const Axes* axes = nullptr;
    const Obb* boxes = nullptr;
    std::uint32_t item_count = 0;  // ids are below it
    std::uint32_t node_count = 0, leaf_count = 0, height = 0;
};

[[nodiscard]] inline TreeArrays arrays_of(const BoxTree& tree) {
    const Structure& structure = tree.structure();
    const auto count = [](std::size_t size) { return static_cast<std::uint32_t>(size); };
    return {structure.nodes().data(),
            structure.leaves().data(),
            structure.leaf_ranges().data(),
            structure.leaf_counts().data(),
            structure.slot_items().data(),
            structure.axes().data(),
            tree.boxes().data(),
            count(tree.boxes().size()),
            count(structure.nodes().size()),
            count(structure.leaves().size()),
            structure.height()};
}

}  // namespace crofton::boxtree
