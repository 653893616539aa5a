// SPDX-License-Identifier: MIT
// Sphere, the solid ball: the cheapest bound.
#pragma once
#include <crofton/core/requirements.hpp>
#include <glm/vec3.hpp>

namespace crofton {

// All points within `radius` ≥ 0 of `center`.
struct Sphere {
    glm::dvec3 center{0.0};
    double radius = 0.0;
};

}  // namespace crofton
