// SPDX-License-Identifier: MIT
// What `crofton triangulate` does with meshes, and with --compare.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/triangulate/triangulate.hpp>
#include <cstddef>
#include <cstdint>
#include <string>

#include "read_options.hpp"

namespace crofton::cli {

// Meshes: their planar patches are triangulated again.
struct MeshRun {
    std::string file, method_name;
    triangulate::TriangulateOptions triangulation;
    std::string json, out;
    double tolerance = -1.0;  // negative: a millionth of each mesh's size
    double attribute_tolerance = 1e-4;
    bool no_indices = false;
    ReadOptions read;
};

// Exit status: kBadInput where a primitive could not be read, the others being done all the same. Prints a table unless
// the JSON goes to stdout. `out` is written whole, or not at all.
[[nodiscard]] Result<int> run_meshes(const MeshRun& run);

// `crofton triangulate --compare`: the three methods side by side.
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
