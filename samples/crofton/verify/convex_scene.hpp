// SPDX-License-Identifier: MIT
// crofton verify collide --scene: shapes made of a scene's or map's data.
#pragma once
#include <crofton/core/error.hpp>
#include <string>
#include <vector>

#include "assets/scene_source.hpp"

#include "rows.hpp"

namespace crofton::cli {

// Verifies queries on a scene: hulls of all meshes and of their pieces, and all of it as one mesh. On a map of
// polygons: a height field, with holes where there is no polygon. Shapes nearly touch these, at 0, 1e3 and 1e7 times
// the size from the origin. Overlap, distances and casts must agree with exact arithmetic on each triangle. Errors: as
// assets::load_scene and read_polygons.
[[nodiscard]] Result<std::vector<VerifyRow>> verify_collided_scene(const std::string& source,
                                                                   const assets::LoadOptions& which,
                                                                   const VerifyOptions& options);

}  // namespace crofton::cli
