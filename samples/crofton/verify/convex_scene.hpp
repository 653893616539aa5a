// SPDX-License-Identifier: MIT
// crofton verify collide --scene: bodies made of a scene's or map's data.
#pragma once
#include <crofton/core/error.hpp>
#include <string>
#include <vector>

#include "rows.hpp"

namespace crofton::cli {

// Hulls of all meshes and of their pieces, and the whole scene as one mesh; of a map of polygons a height field, with
// holes where there is none. Bodies that nearly touch these are told to meet or not as exact arithmetic tells of each
// triangle, at 0, 1e3 and 1e7 times the size from the origin; distances and casts likewise. Errors: as
// assets::load_scene and read_polygons.
[[nodiscard]] Result<std::vector<VerifyRow>> verify_collided_scene(const std::string& source,
                                                                   const VerifyOptions& options);

}  // namespace crofton::cli
