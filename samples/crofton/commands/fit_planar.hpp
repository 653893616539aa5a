// SPDX-License-Identifier: MIT
// What `crofton fit --planar` does.
#pragma once
#include <crofton/core/error.hpp>
#include <string>
#include <vector>

#include "read_options.hpp"

namespace crofton::cli {

// `crofton fit --planar`: the best rectangle, disc and triangle around polygons, with what proves them best.
struct PlanarFitRun {
    std::vector<std::string> files;  // as read_polygons takes them
    std::string json_path, svg_path;
    ReadOptions read = {};
    std::size_t drawn = 12;  // polygons in the picture, the largest hulls first
};

// Fits around the outer ring of every polygon. A polygon that is refused is named on stderr and makes the exit status
// kBadInput; the others are done.
[[nodiscard]] Result<int> run_fit_planar(const PlanarFitRun& run);

}  // namespace crofton::cli
