// SPDX-License-Identifier: MIT
// Line: unbounded on both sides.
#pragma once
#include <crofton/core/requirements.hpp>
#include <glm/vec3.hpp>

namespace crofton {

// The points point + t · direction for all real t. `direction` is a unit vector; the line has no sense of direction
// unless its user says so.
struct Line {
    glm::dvec3 point{0.0};
    glm::dvec3 direction{0.0, 0.0, 1.0};
};

}  // namespace crofton
