// SPDX-License-Identifier: MIT
// Large meshes into pieces that culling can tell apart.
#pragma once
#include <crofton/geometry/mesh.hpp>
#include <vector>

namespace crofton::assets {

// Halves at the median centroid along the longer side until no piece has more than `limit` triangles. Every triangle is
// in exactly one piece, vertices keep their bits; pieces come in order of space. `mesh` is valid; limit ≥ 1.
[[nodiscard]] std::vector<TriangleMesh> split_mesh(TriangleMesh mesh, std::size_t limit);

}  // namespace crofton::assets
