// SPDX-License-Identifier: MIT
// `crofton bake --regions`: a scene as a folder of regions, and what such a folder holds.
#pragma once
#include <crofton/bake/baked_scene.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/pvs/pvs.hpp>
#include <cstdint>
#include <string>

#include "assets/scene_source.hpp"

namespace crofton::cli {

struct RegionGrid {
    std::uint32_t columns = 1, rows = 1;
};
// Reads "8x4". Error: another text.
[[nodiscard]] Result<RegionGrid> region_grid_from(const std::string& text);

struct RegionBake {
    RegionGrid grid;
    std::string folder;
    pvs::Shard shard;   // bakes the regions at places shard.index + k shard.count
    std::string state;  // a file with what is done, to continue from; empty: one in the folder while it is unfinished
    std::string json;   // a file or "-" for the figures; may be empty
};

// Writes a file for each region, in parallel, then the index, so that a folder with an index is complete. Regions that
// the state has are not baked again, unless their file has changed. A shard writes its files and its state, and leaves
// the index to merge_region_states(). Returns the exit status.
int write_regions(const assets::SceneSource& source, const RegionBake& bake, const bake::BakeOptions& options,
                  Executor& executor);

// Opens all regions of a folder, attaches them to a World, and says how long that took.
int check_regions(const std::string& folder, std::uint64_t largest_file, const std::string& json, Executor& executor);

}  // namespace crofton::cli
