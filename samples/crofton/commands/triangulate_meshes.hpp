// SPDX-License-Identifier: MIT
// What `crofton triangulate` does with meshes.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/triangulate/triangulate.hpp>
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
    ReadOptions read;
};

// Exit status: kBadInput where a primitive could not be read, the others being done all the same. Prints a table unless
// the JSON goes to stdout. `out` is written whole, or not at all.
[[nodiscard]] Result<int> run_meshes(const MeshRun& run);

}  // namespace crofton::cli
