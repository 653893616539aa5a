// The vertices of a mesh file: all that a box needs of it.
#pragma once
#include <crofton/core/error.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace crofton::cli {

// The `v` lines of a Wavefront OBJ file, in order, used by faces or not. Errors name the file, the line and the reason.
[[nodiscard]] Result<std::vector<glm::dvec3>> read_obj_vertices(const std::string& path);

}  // namespace crofton::cli
