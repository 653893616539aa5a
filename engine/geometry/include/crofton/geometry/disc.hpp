// SPDX-License-Identifier: MIT
// Disc: a solid circle of the plane.
#pragma once
#include <crofton/core/requirements.hpp>
#include <glm/vec2.hpp>

namespace crofton {

// All points within `radius` ≥ 0 of `center`.
struct Disc {
    glm::dvec2 center{0.0};
    double radius = 0.0;
};

}  // namespace crofton
