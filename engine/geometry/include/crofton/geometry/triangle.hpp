// SPDX-License-Identifier: MIT
// A triangle in space, by its vertices.
#pragma once
#include <array>
#include <crofton/core/requirements.hpp>
#include <glm/vec3.hpp>

namespace crofton {

using Triangle = std::array<glm::dvec3, 3>;

}  // namespace crofton
