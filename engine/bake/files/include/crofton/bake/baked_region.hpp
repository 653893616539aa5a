// SPDX-License-Identifier: MIT
// Regions of a World from baked files.
#pragma once
#include <crofton/bake/baked_scene.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/world/region.hpp>
#include <cstdint>

namespace crofton::bake {

struct BakedRegionOptions {
    // Rays, probes and contacts test the triangles, for which a tree is built over each mesh. False: they test the
    // meshes' boxes.
    bool triangles = true;
    std::uint32_t collides_with = ~0u;  // of all objects, as RegionObject
    RegionOptions region = {};          // `meshes` and `built` are not read
    // Objects hide others in views with OcclusionOptions. False: their occluders are not prepared, which takes half of
    // the time; a picture's views (ViewRequest::picture) need none.
    bool occluders = true;
    // Takes the scene's tree without checking that its bounds contain the boxes below them: wrong bounds would lose
    // objects later. Links and counts are checked in any case. For files of your own: checksums find accidents, but
    // tell nothing of who wrote the file. The check takes 0.12 s for a million objects.
    bool trust_contents = false;
};

// Prepares a region of a baked scene's instances, on any thread: open() on a thread that loads, then this. The origin
// of the region is that of the scene's coordinates.
//
// The object at place i is instance i, with the user data i, its mesh, its layers and where its node stands; a removed
// instance is in no layer. A node's occluders hide by its first instance, if all its instances are in the same layers;
// meshes that were baked with clusters have clusters. Meshes have the boxes of the file. Everything is copied: the
// scene may be destroyed afterwards, and nothing is read from its file later. Errors: as Region::prepare; a mesh, the
// item, with a vertex outside its box.
[[nodiscard]] Result<Region> prepare_region(const BakedScene& scene, const BakedRegionOptions& options = {},
                                            Executor& executor = serial_executor());
// The same, and takes the scene's tree if it was baked for the region's max_origin (BakeOptions::region_max_origin),
// instead of building one. RegionOptions::tree is then not read. Errors: also `parse` for a tree whose bounds, layers
// or lanes are not those of its boxes, with `item` the node, leaf or instance.
[[nodiscard]] Result<Region> prepare_region(BakedScene&& scene, const BakedRegionOptions& options = {},
                                            Executor& executor = serial_executor());

}  // namespace crofton::bake
