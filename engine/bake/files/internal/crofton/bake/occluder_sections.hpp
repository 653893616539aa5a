// SPDX-License-Identifier: MIT
// The occluders' place in the file.
#pragma once
#include <crofton/bake/baked_scene.hpp>
#include <crofton/bake/container.hpp>
#include <optional>

namespace crofton::bake {

// A record of the section `occluder`; `first` and `count` are ranges of the sections `occpoint` and `occindex`.
struct OccluderRecord {
    Obb box;
    Aabb piece_bounds, eyes_within;
    double mean_shadow = 0.0, gain = 0.0;
    std::uint64_t first_point = 0, first_index = 0;
    std::uint32_t point_count = 0, index_count = 0, edges = 0;
    std::uint8_t kind = 0, sides = 0;
    std::uint8_t reserved[2] = {};
};
// A record of the section `occkinds`: a range of `occluder`.
struct OccluderKindRecord {
    std::uint32_t first = 0, count = 0;
};
static_assert(sizeof(OccluderRecord) == 216 && sizeof(OccludingNode) == 8);

// Errors: those of read_occluders, so that what has been written can be read.
[[nodiscard]] Result<void> add_occluders(const BakedOccluders& occluders, std::size_t node_count, Writer& writer);
// Returns no occluders if the file has no such sections. Errors: what is out of its range, no number or no box, with
// the occluder, kind or place among the nodes as item.
[[nodiscard]] Result<std::optional<BakedOccluders>> read_occluders(const Reader& reader, std::size_t node_count);

}  // namespace crofton::bake
