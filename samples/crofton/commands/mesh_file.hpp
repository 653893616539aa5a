// SPDX-License-Identifier: MIT
// One mesh, or one set of points, from any file that scenes come in.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/geometry/mesh.hpp>
#include <string>
#include <vector>

#include "read_options.hpp"

namespace crofton::cli {

struct PlacedMesh {
    TriangleMesh mesh;
    glm::dvec3 origin{0.0};  // in the world; 0, unless the mesh is so far out that floats are coarse there
};

// .obj: vertices and faces in the order of the file, polygons cut into triangles, everything else left out. Any other
// format: all instances in one. Errors name the file, the line or item, and the reason. Of an .obj file
// nothing is left out: a line that makes no sense is an error.
[[nodiscard]] Result<PlacedMesh> load_mesh(const std::string& path, const ReadOptions& options = {});

// .obj: the `v` lines in order, used by faces or not. Any other format: the vertices of all instances, in world space.
[[nodiscard]] Result<std::vector<glm::dvec3>> load_points(const std::string& path, const ReadOptions& options = {});

}  // namespace crofton::cli
