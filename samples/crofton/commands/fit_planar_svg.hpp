// SPDX-License-Identifier: MIT
// Bounds of the plane as a picture.
#pragma once
#include <crofton/geometry/shapes.hpp>
#include <glm/vec2.hpp>
#include <string>
#include <vector>

namespace crofton::cli {

struct PlanarShape {
    const char* name;
    std::vector<glm::dvec2> outline;  // empty: a disc
    Disc disc;
    std::vector<glm::dvec2> contacts;  // where a best one must touch, or does
    double value = 0.0;
    const char* certificate = "";
    double off = 0.0;  // how far contacts that must be are missed, over the hull's perimeter
};

struct PlanarFit {
    std::string name;
    std::vector<glm::dvec2> ring, hull;
    double hull_area = 0.0, hull_perimeter = 0.0;
    std::vector<PlanarShape> shapes;  // rectangles by perimeter and area, disc, triangles by perimeter and area
};

// A row of three panels for each of the `most` polygons with the most corners on the hull: rectangles, disc, triangles;
// contacts as dots.
[[nodiscard]] std::string planar_fits_svg(const std::vector<PlanarFit>& fits, std::size_t most);

}  // namespace crofton::cli
