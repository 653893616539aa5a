// SPDX-License-Identifier: MIT
// A half-space, by its boundary plane.
#pragma once
#include <crofton/core/requirements.hpp>
#include <glm/vec3.hpp>

namespace crofton {

// The points x with dot(normal, x) + offset >= 0: the normal points inward, to the side that is kept.
struct Plane {
    glm::dvec3 normal{0.0};
    double offset = 0.0;
};

}  // namespace crofton
