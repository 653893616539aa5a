// SPDX-License-Identifier: MIT
// What a bake of regions has done so far, as a file: to continue it, and to merge its shards.
#pragma once
#include <crofton/bake/region_files.hpp>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "assets/scene_source.hpp"

namespace crofton::cli {

struct RegionState {
    struct Done {
        bake::RegionFile file;
        std::uint64_t checksum = 0;  // of the file's contents
        friend bool operator==(const Done& a, const Done& b) {
            return a.checksum == b.checksum && a.file.name == b.file.name && a.file.bytes == b.file.bytes;
        }
    };
    std::uint64_t key = 0;               // of the scene and of the options: region_key()
    std::uint32_t regions = 0;           // of the whole bake
    std::map<std::uint32_t, Done> done;  // by the region's place in the index
};

// Returns a sum of all that the regions' files depend on: equal for the same scene, grid and options.
[[nodiscard]] std::uint64_t region_key(const assets::SceneSource& source, std::uint32_t columns, std::uint32_t rows,
                                       const bake::BakeOptions& options, Executor& executor);

// The same state has the same bytes, in whatever order its regions were baked.
[[nodiscard]] Result<Vector<std::byte>> to_file(const RegionState& state);
[[nodiscard]] bool is_region_state(std::span<const std::byte> file);
// Errors: damage; a place that is beyond the regions, or is there twice.
[[nodiscard]] Result<RegionState> region_state_from(std::span<const std::byte> file);

// Says whether the region's file in this folder is the one that was baked. Errors name the file.
[[nodiscard]] Result<void> check_region_file(const std::string& folder, const RegionState::Done& done,
                                             Executor& executor);

// Writes `out`, the index of a folder that has the files of all parts' regions, as one run would have written it.
// Returns the shards that are missing, of so many: the index is not written then. Errors name the part or the file.
[[nodiscard]] Result<std::vector<std::uint32_t>> merge_region_states(std::span<const std::string> names,
                                                                     std::span<const std::span<const std::byte>> parts,
                                                                     const std::string& out, std::uint32_t shards,
                                                                     Executor& executor);

}  // namespace crofton::cli
