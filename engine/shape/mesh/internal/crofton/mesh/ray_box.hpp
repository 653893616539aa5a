// SPDX-License-Identifier: MIT
// A ray against a box, both known to be valid.
#pragma once
#include <crofton/mesh/mesh_query.hpp>
#include <optional>

namespace crofton::mesh {

[[nodiscard]] std::optional<double> entry_of(const Ray& ray, const Obb& box);

}  // namespace crofton::mesh
