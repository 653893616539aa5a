// SPDX-License-Identifier: MIT
// Finds the polygons, with holes, that the lines around a sector enclose.
#pragma once
#include <crofton/geometry/mesh.hpp>
#include <string>
#include <vector>

#include "assets/wad_file.hpp"

namespace crofton::assets {

struct SectorPolygons {
    std::vector<Polygon> polygons;  // in map units, outer rings counter-clockwise
    std::string problem;            // why a part or all of the sector is missing; empty where all is well
};

// By sector. Lines with the same sector on both sides bound nothing. Rings are traced along lines with the sector to
// the left, taking the sharpest left turn where several go on, and cut where they touch themselves, so that each visits
// a vertex once; a hole belongs to the smallest outer ring around it. A sector whose lines do not close has no
// polygons.
[[nodiscard]] std::vector<SectorPolygons> sector_polygons(const WadLevel& level);

}  // namespace crofton::assets
