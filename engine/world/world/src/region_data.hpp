// SPDX-License-Identifier: MIT
// The data that copies of a Region share.
#pragma once
#include <atomic>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/world/region.hpp>
#include <memory>
#include <utility>

#include "mesh_clusters.hpp"
#include "object_shapes.hpp"
#include "shapes.hpp"

namespace crofton::world {

struct RegionData {
    // What an object is beside its box and its layers, which are the tree's.
    struct Item {
        std::uint64_t user = 0;
        double radius = 0.0;  // of a sphere
        std::uint32_t collides_with = ~0u;
        BoundKind kind = BoundKind::box;
    };
    struct Mesh {
        MeshShape shape;
        TriangleMesh triangles;  // empty: the tree is not usable
        MeshClusters::Mesh clusters;
        Vector<occlude::FoundOccluder> occluders;
    };
    // What an object has that is more than a bound.
    struct Solid {
        Transform transform;                 // relative to the origin
        bool has_transform = false;          // false: it is a bound with a shape
        std::uint32_t mesh = kNoIndex;       // in `meshes`
        std::uint32_t shape = kNoIndex;      // in `shapes`
        bool occludes = false;               // its mesh hides others
        std::uint32_t occluding_layers = 0;  // of views in which its occluders do; 0: it has none
    };

    explicit RegionData(boxtree::BoxTree&& built) : tree(std::move(built)) {}

    std::shared_ptr<const void> keep;  // released last
    boxtree::BoxTree tree;
    Vector<Item> items;
    Vector<std::uint32_t> solid_of_item;  // kNoIndex: a bound; empty: all are bounds
    Vector<Solid> solids;
    Vector<PlacedShape> shapes;  // poses are relative to the origin
    Vector<Mesh> meshes;
    Vector<std::uint32_t> occluding;  // items with occluders, ascending
    double max_origin = 0.0;          // where there are solids
    Aabb bounds;
    double most_radius = 0.0;         // no half diagonal of a box is longer
    std::uint32_t any_layers = 0;     // that an object has
    std::uint32_t common_layers = 0;  // that all have
    mutable std::atomic<std::uint32_t> owners{1};

    [[nodiscard]] const Solid* solid(std::uint32_t item) const {
        if (solid_of_item.empty() || solid_of_item[item] == kNoIndex) return nullptr;
        return &solids[solid_of_item[item]];
    }
    [[nodiscard]] const PlacedShape* shape(std::uint32_t item) const {
        const Solid* const found = solid(item);
        return found != nullptr && found->shape != kNoIndex ? &shapes[found->shape] : nullptr;
    }
};

}  // namespace crofton::world
