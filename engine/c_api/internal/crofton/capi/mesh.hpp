// SPDX-License-Identifier: MIT
// Meshes as C gives them.
#pragma once
#include <crofton/capi/modules.h>

#include <crofton/geometry/mesh.hpp>

namespace crofton::capi {

// Checks its pointers and numbers, and reads none of it.
[[nodiscard]] crofton_status check_mesh(const crofton_mesh* mesh, const char* function);

// Copies the mesh; what its numbers must be is for the callee to say.
[[nodiscard]] crofton_status to_mesh(const crofton_mesh* mesh, const char* function, TriangleMesh& result);

}  // namespace crofton::capi
