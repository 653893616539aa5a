// SPDX-License-Identifier: MIT
// `crofton pvs` over a folder of regions: visible sets for each.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/pvs/pvs.hpp>
#include <cstdint>
#include <string>

namespace crofton::cli {

struct RegionSetsBake {
    std::string folder;
    glm::uvec3 cells{8, 1, 8};  // of each region
    double height = 10.0;       // of the cells, as pipeline::eyes_of()
    double reach = 0.0;         // of the cells in x and z beyond the region
    pvs::BakeOptions lines;
    pvs::ProofOptions proofs;
    pvs::Shard shard;  // bakes the sets of the regions at places shard.index + k shard.count
    std::uint64_t largest_file = 0;
    std::string json;
};

// Writes a file of sets beside each region's, in parallel. Sets that are there, of the same region and options, are not
// baked again: an interrupted run continues, and shards need no merging. Returns the exit status.
int bake_region_sets(const RegionSetsBake& bake, Executor& executor);

}  // namespace crofton::cli
