// SPDX-License-Identifier: MIT
// Prints the results of `crofton fit` as JSON, text and a drawing.
#pragma once
#include <crofton/geometry/box.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "json/json.hpp"

namespace crofton::cli {

struct FittedBox {
    std::string criterion;  // as the user wrote it
    Obb box;
    double value = 0.0;
    std::optional<double> lower_bound;  // of `exact` only: the others prove nothing
    std::optional<double> gap;
    std::optional<double> rounding;  // the part of the gap that storing the axes as floats costs
    double milliseconds = 0.0;       // of the search, which needs no hull
};

struct FittedMesh {
    std::string file;
    std::size_t vertices = 0, hull_vertices = 0;
    double hull_milliseconds = 0.0;  // for its count and the drawing: the search uses no hull
    // For the drawing: the hull's triangles, three corners each; of a flat set the outline instead, two ends each.
    std::vector<glm::dvec3> hull_triangles, outline;
    FittedBox chosen;
    std::vector<FittedBox> others;  // volume, area and perimeter, when several files are compared
};

[[nodiscard]] Json fit_json(const std::vector<FittedMesh>& meshes, const std::string& quality);
[[nodiscard]] std::string fit_text(const std::vector<FittedMesh>& meshes);
[[nodiscard]] std::string fit_svg(const std::vector<FittedMesh>& meshes);

}  // namespace crofton::cli
