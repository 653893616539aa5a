// SPDX-License-Identifier: MIT
// The same scene cut into triangles anew, to compare ways of triangulating.
#pragma once
#include <crofton/triangulate/triangulate.hpp>

#include "scene_source.hpp"

namespace crofton::assets {

// Polygons by their rings, other meshes patch by planar patch; what cannot be triangulated so (an area that rounding
// would turn over, a ring that crosses itself) stays as it is. Ids of nodes, meshes and instances, vertices and counts
// of triangles stay; emission, which is by triangle, is left out. Errors: as Scene's add_ calls.
[[nodiscard]] Result<void> retriangulate(SceneSource& source, const LoadOptions& options, triangulate::Method method);

}  // namespace crofton::assets
