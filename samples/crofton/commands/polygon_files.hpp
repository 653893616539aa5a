// SPDX-License-Identifier: MIT
// Polygons with holes out of files of several formats.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/geometry/mesh.hpp>
#include <string>
#include <vector>

#include "assets/read_limits.hpp"

namespace crofton::cli {

struct NamedPolygon {
    std::string name;
    Polygon polygon;
};

struct PolygonFile {
    std::vector<NamedPolygon> polygons;
    std::vector<std::string> warnings;  // what the file held that is no polygon
    bool one_plane = false;             // the polygons lie beside each other, as on a map
};

// .poly ("P name rings", then a line "n x y x y …" per ring), .json (earcut's rings [[[x, y], …], …], or GeoJSON with
// Polygon and MultiPolygon geometries anywhere in it; the repeated closing points are left out), .geojson, .wad (every
// sector of every level, or of `map`). Errors name the file, the item in it and the reason; a limit that is passed, of
// which `triangles` counts a polygon's points.
[[nodiscard]] Result<PolygonFile> read_polygons(const std::string& path, const std::string& map,
                                                const assets::ReadLimits& limits = {});
[[nodiscard]] bool is_polygon_file(const std::string& path);

}  // namespace crofton::cli
