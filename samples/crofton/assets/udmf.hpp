// SPDX-License-Identifier: MIT
// A level's lines and sectors in the Universal Doom Map Format, the text of a TEXTMAP lump.
#pragma once
#include <crofton/core/error.hpp>
#include <string_view>

#include "assets/wad_file.hpp"

namespace crofton::assets {

// The level without its name. Coordinates are rounded to 1/32,768 of a unit, so that what is decided about rings is
// exact. Comments, blocks and fields that say nothing about lines and sectors are skipped, slopes and 3D floors among
// them. Errors name the line of the text: no such text, a number that is none or beyond 32,767, a field that is
// missing.
[[nodiscard]] Result<WadLevel> read_udmf(std::string_view text);

}  // namespace crofton::assets
