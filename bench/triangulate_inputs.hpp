// SPDX-License-Identifier: MIT
// Polygons to measure with: the shared files, and contours of noise of any size.
#pragma once
#include <crofton/geometry/mesh.hpp>
#include <cstdint>
#include <string>
#include <vector>

namespace crofton::bench {

// "P name rings", then "n x y x y …" per ring; empty where the file is absent. Polygons of more than `most` points are
// left out.
[[nodiscard]] std::vector<Polygon> read_poly_file(const std::string& path, std::size_t most);

// The largest region where smooth noise on a `side` × `side` grid exceeds `level` (its mean is 0), by marching squares
// with linear interpolation; `wavelength` in cells. With or without its holes. The same for the same arguments.
struct Contours {
    std::uint32_t side = 100;
    double wavelength = 12.0;
    double level = 0.0;
    bool holes = true;
};
[[nodiscard]] Polygon noise_contours(const Contours& contours);

}  // namespace crofton::bench
