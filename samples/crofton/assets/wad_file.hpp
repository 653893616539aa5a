// SPDX-License-Identifier: MIT
// DOOM's archive of lumps, and a level's lines and sectors in it.
#pragma once
#include <crofton/core/error.hpp>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace crofton::assets {

inline constexpr std::uint32_t kNoSide = 0xFFFF;

struct WadLevel {
    struct Vertex {
        int x = 0, y = 0;
    };
    struct Line {
        std::uint32_t from = 0, to = 0;                 // vertices
        std::uint32_t right = kNoSide, left = kNoSide;  // sides, seen from `from` to `to`
    };
    struct Side {
        std::uint32_t sector = 0;
        std::string upper, lower, middle;  // texture names, "-" for none
    };
    struct Sector {
        int floor = 0, ceiling = 0, light = 255;
        std::string floor_texture, ceiling_texture;
    };
    std::string name;
    std::vector<Vertex> vertices;
    std::vector<Line> lines;
    std::vector<Side> sides;
    std::vector<Sector> sectors;
};

// The names of all levels in the file's bytes, in order. Errors: not a WAD, a directory beyond the end, no level.
[[nodiscard]] Result<std::vector<std::string>> list_levels(std::string_view wad);

// One level; the first where `name` is empty; letter case does not matter. Errors: as above, no such level (the message
// lists those that are), a lump missing, beyond the end or of a broken size, a line, side or sector out of range.
[[nodiscard]] Result<WadLevel> read_level(std::string_view wad, const std::string& name);

}  // namespace crofton::assets
