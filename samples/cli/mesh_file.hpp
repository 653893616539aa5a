// One mesh from a file, for questions about triangles.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/geometry/triangle_mesh.hpp>
#include <string>

namespace crofton::cli {

// .obj: vertices and faces in the order of the file, polygons cut into fans, everything else left out. Any other format
// that scenes come in: all instances in one. Errors name the file, the line or item, and the reason.
[[nodiscard]] Result<TriangleMesh> load_mesh(const std::string& path);

}  // namespace crofton::cli
