// SPDX-License-Identifier: MIT
// DOOM's archive of lumps, and a level's lines and sectors in it, in the binary formats of DOOM and Hexen or as text
// (UDMF).
#pragma once
#include <crofton/core/error.hpp>
#include <cstdint>
#include <glm/vec2.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace crofton::assets {

inline constexpr std::uint32_t kNoSide = ~std::uint32_t{0};

struct WadLevel {
    struct Vertex {
        int x = 0, y = 0;  // below 2^30 in magnitude
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
    double units = 1.0;  // of a vertex's coordinates in a unit of the map
    std::vector<Vertex> vertices;
    std::vector<Line> lines;
    std::vector<Side> sides;
    std::vector<Sector> sectors;

    [[nodiscard]] glm::dvec2 position(std::uint32_t vertex) const {
        return {vertices[vertex].x / units, vertices[vertex].y / units};
    }
};

// The names of all levels in the file's bytes, in order. Errors: not a WAD, a directory beyond the end, no level.
[[nodiscard]] Result<std::vector<std::string>> list_levels(std::string_view wad);

// One level; the first where `name` is empty; letter case does not matter. Errors: as above, no such level (the message
// lists those that are), a lump missing, beyond the end or of a broken size, a line, side or sector out of range, a
// text that is no UDMF.
[[nodiscard]] Result<WadLevel> read_level(std::string_view wad, const std::string& name);

}  // namespace crofton::assets
