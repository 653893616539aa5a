// SPDX-License-Identifier: MIT
// Cells and shards as they are typed.
#pragma once
#include <cmath>
#include <crofton/pvs/pvs.hpp>
#include <optional>
#include <span>
#include <string>

#include "assets/scene_source.hpp"

namespace crofton::cli {

struct RoomOptions {
    double inset = 0.0;      // from walls, floors and ceilings
    double size = HUGE_VAL;  // no cell is longer in x or z
};

// "NXxNYxNZ" over `eyes`; "rooms", a level's rooms cut by the options; or a file with a cell a line. Six numbers are a
// box, min and max. Twelve to 24 are four to eight corners of a convex cell. Lines that begin with # are comments.
// Errors name the file and the line, and a scene that has no rooms.
[[nodiscard]] Result<pvs::Cells> cells_from(const std::string& text, const Aabb& eyes,
                                            const assets::SceneSource& source, const RoomOptions& rooms,
                                            const assets::ReadLimits& limits);
// "NXxNYxNZ"; nothing of another text.
[[nodiscard]] std::optional<glm::uvec3> grid_from(const std::string& text);
// "i/n" with 0 ≤ i < n; "": all.
[[nodiscard]] Result<pvs::Shard> shard_from(const std::string& text);
// "x,y,z…": as many numbers as `numbers` has room for.
[[nodiscard]] Result<void> read_numbers(const char* option, const std::string& text, std::span<double> numbers);

}  // namespace crofton::cli
