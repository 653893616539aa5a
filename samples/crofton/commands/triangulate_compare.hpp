// SPDX-License-Identifier: MIT
// The three methods side by side.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/triangulate/triangulate.hpp>
#include <cstddef>
#include <cstdint>
#include <string>

#include "read_options.hpp"

namespace crofton::cli {

struct CompareRun {
    std::string file, map, json;
    triangulate::TriangulateOptions limits;  // of each method
    double tolerance = -1.0;
    std::uint64_t frusta = 100'000;
    ReadOptions read;
    std::size_t least_vertices = 5;  // smaller polygons leave little choice
};

// Weights of all methods over a file's polygons, or its meshes' planar patches; triangles passed by random frusta and
// pixel quads, predicted and measured; triangles clipped and draw time. Exit status; prints a table unless the JSON
// goes to stdout.
[[nodiscard]] Result<int> run_compare(const CompareRun& run);

}  // namespace crofton::cli
