// SPDX-License-Identifier: MIT
// Intersects a ray with a box; both are known to be valid.
#pragma once
#include <crofton/mesh/mesh_query.hpp>
#include <optional>

namespace crofton::mesh {

[[nodiscard]] std::optional<double> entry_of(const Ray& ray, const Obb& box);

}  // namespace crofton::mesh
