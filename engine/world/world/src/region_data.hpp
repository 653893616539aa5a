// SPDX-License-Identifier: MIT
// What copies of a Region share.
#pragma once
#include <atomic>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/world/region.hpp>
#include <utility>

namespace crofton::world {

struct RegionData {
    // What an object is beside its box and its layers, which are the tree's.
    struct Item {
        std::uint64_t user = 0;
        double radius = 0.0;  // of a sphere
        std::uint32_t collides_with = ~0u;
        BoundKind kind = BoundKind::box;
    };

    explicit RegionData(boxtree::BoxTree&& built) : tree(std::move(built)) {}

    boxtree::BoxTree tree;
    Vector<Item> items;
    Aabb bounds;
    double most_radius = 0.0;         // no half diagonal of a box is longer
    std::uint32_t any_layers = 0;     // that an object has
    std::uint32_t common_layers = 0;  // that all have
    mutable std::atomic<std::uint32_t> owners{1};
};

}  // namespace crofton::world
